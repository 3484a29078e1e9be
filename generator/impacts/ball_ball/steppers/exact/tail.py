"""The step into sticking: in one step c_z falls as (1 - t)^2."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp

from .....lowering.counts import OperationCounts
from .....lowering.printer import Plus, number
from .....lowering.statements import Assign, Part
from ... import symbols as s
from .writing import KIND, StepText, ordered_sum, rational, symbol


class TailText(StepText):
    """Its stages and what they may be off."""

    @property
    def tail_bend(self) -> sp.Expr:
        """On the way into sticking c_x / c_z is as this power of 1 - t without table friction."""
        k_x, k_z = self.changes[s.C_X].coeff(s.D_X), self.changes[s.C_Z].coeff(s.D_Z)
        return sp.cancel(2 * (k_x / k_z - 1))

    def _bent(self, left: float) -> str:
        """That power of what is left; of masses that are given, in the kernel."""
        if self.tail_bend.is_number:
            return repr(left ** float(self.tail_bend))
        return f"std::pow({left!r}, start.bend)"

    def tail(self) -> Part:
        """The stages of the step into sticking: c_z falls as (1 - t)^2."""
        tableau, parts = self.tableau, ("x", "y", "q", "r")
        lines, counts = [], OperationCounts()
        for i in range(1, tableau.stages):
            row = tableau.a[i]
            moves = []
            for part in parts:
                weights = [
                    (w, symbol(f"w{j}.k.{part}"))
                    for j, w in enumerate(row)
                    if w != 0 and tableau.c[j] < 1
                ]
                total = ordered_sum(weights, self.place_fma)
                moves.append(
                    Assign(
                        f"z{i}_{part}", Plus(symbol("r_0"), total) if part == "r" else total, KIND
                    )
                )
            block = self._part(moves)
            values = ", ".join(f"z{i}_{part}" for part in parts)
            left = 1 - tableau.c[i]
            # All are zero at the end.
            values_left = f"{number(rational(left))}, {self._bent(float(left))}"
            rates = f"tail_rates(start, at, s_x0, s_y0, z{i}, {values_left})"
            if left > 0 or i == tableau.stages - 1:
                lines += [*block.lines, f"const Tail z{i} = {{{values}}};"]
            if left > 0:
                lines.append(f"const TailRates w{i} = {rates};")
            counts = counts + block.counts
        assigns = self._tail_errors(tableau.error, "e5" if tableau.second else "e", parts[:2])
        assigns += self._tail_errors(tableau.error, "e", parts[2:3])
        joint: tuple[str, ...] = ()
        if tableau.second:
            assigns += self._tail_errors(tableau.second_error, "e3", parts[:2])
            joint = tuple(f"{KIND} e_{n} = joint_error(e5_{n}, e3_{n});" for n in parts[:2])
        work = self._tail_work()
        end = self._part([*assigns, *work])
        return Part((*lines, *end.lines, *joint), counts + end.counts)

    def _tail_work(self) -> list[Assign]:
        """The work of table friction, and the embedded error of it."""
        tableau = self.tableau
        before = [j for j in range(tableau.stages) if tableau.c[j] < 1]
        weights = {
            name: [(row[j], j) for j in before if row[j] != 0]
            for name, row in (("dj", tableau.b), ("e_j", tableau.error))
        }
        used = sorted({j for row in weights.values() for _, j in row})
        rates = [Assign(f"p{j}", symbol(f"w{j}.v") * symbol(f"w{j}.k.y"), KIND) for j in used]
        sums = [
            Assign(name, ordered_sum([(w, symbol(f"p{j}")) for w, j in row], self.place_fma), KIND)
            for name, row in weights.items()
        ]
        return [*rates, *sums]

    def _tail_errors(
        self, row: Sequence[Fraction], prefix: str, parts: Sequence[str]
    ) -> list[Assign]:
        used = [(w, j) for j, w in enumerate(row) if w != 0 and self.tableau.c[j] < 1]
        if not used:
            raise ValueError(
                f"tableau {self.tableau.name}: its error estimate weighs only stages at the end of "
                "a step, so it sees nothing of the step into sticking, whose rates are zero there; "
                "expected a weight for a stage before the end"
            )
        return [
            Assign(
                f"{prefix}_{part}",
                ordered_sum([(w, symbol(f"w{j}.k.{part}")) for w, j in used], self.place_fma),
                KIND,
            )
            for part in parts
        ]
