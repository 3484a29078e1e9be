"""The stages of an exact step: slips from the impulses of earlier stages, and impulses there."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import sympy as sp

from .....lowering.counts import OperationCounts
from .....lowering.statements import Assign, Part
from ... import symbols as s
from .writing import EMPTY, KIND, SLIPS, H, StepText, rate, rational, symbol


@dataclass(frozen=True)
class Kept:
    """What a stage leaves for later, by type, and what it uses of what earlier ones left."""

    uses: tuple[str, ...]
    rates: tuple[str, ...]
    slips: tuple[str, ...]
    numbers: tuple[str, ...]


class Stages(StepText):
    """Rates and stages. What is known last is added last."""

    def _rates(self) -> Part:
        """Rates with the inverse lengths multiplied in last, which keeps the critical chain short.

        p = -u_b c is contact friction times |c|, z = -u_s p_z s table friction times |c| |s|.
        """
        p_z, i_c = symbol("p_z"), symbol("i_c")
        slips = {name: symbol(f"at.{name}") for name in self.slips}
        assigns = [
            Assign("p_x", -symbol("u_b") * slips["c_x"], KIND),
            Assign("p_z", -symbol("u_b") * slips["c_z"], KIND),
        ]
        if self.table:
            assigns += [
                Assign("g", -symbol("start.u_s") * p_z, KIND),
                Assign("z_x", symbol("g") * slips["s_x"], KIND),
                Assign("z_y", symbol("g") * slips["s_y"], KIND),
            ]
        rubbed = [Assign(f"r_d_{axis}", i_c * symbol(f"p_{axis}"), KIND) for axis in "xz"]
        if not self.table:
            return self._part([*assigns, *rubbed])
        if not self.split_roots:
            i_cs = symbol("i_cs")
            assigns += [Assign("i_cs", i_c * symbol("i_s"), KIND), *rubbed]
            assigns += [Assign(f"r_t_{axis}", i_cs * symbol(f"z_{axis}"), KIND) for axis in "xy"]
            return self._part(assigns)
        over = tuple(f"{KIND} r_d_{axis} = root_c.of(p_{axis});" for axis in "xz")
        over += tuple(f"{KIND} l_{axis} = root_s.of(z_{axis});" for axis in "xy")
        slid = [Assign(f"r_t_{axis}", i_c * symbol(f"l_{axis}"), KIND) for axis in "xy"]
        before, after = self._part(assigns), self._part(slid)
        return Part((*before.lines, *over, *after.lines), before.counts + after.counts)

    def _stage(self, i: int, rates: OperationCounts) -> Part:
        """Slips at stage i, and the impulses there by `rates_at`."""
        row = self.tableau.rows[i]
        last = max(j for j, w in enumerate(row) if w != 0)
        needed = self.table or self.gains  # later, of the last stage's sums
        whole = self.lanes or (i == self.tableau.stages - 1 and needed)
        split = not self.lanes
        assigns: list[Assign] = []
        early = f"m{i}_" if split and last > 0 else ""
        if early:
            assigns += self._sums_of_rates(row[:last], early)
        if not split or whole or (self.table and self._counts_power(i)):
            names = tuple(self.impulses) if whole else ("t_y",)
            assigns += self._sums_of_rates(row, f"sum{i}_", names)
        share = rational(self.tableau.c[i])
        for name in self.slips:
            start = symbol(f"at.{name}")
            if split:
                base = self._moved_by_q(name, share)
                if early:
                    base = self._moved(name, start, early, H, share)
                value = self._moved_by_last(name, base, row[last], last)
            else:
                value = self._moved(name, start, f"sum{i}_", H, share)
            assigns.append(Assign(f"{name}{i}", value, KIND))
        part = self._part(assigns)
        state = f"const Slips y{i} = {{{', '.join(f'{name}{i}' for name in self.slips)}}};"
        call = f"const Rates k{i} = rates_at(start, y{i}, h);"
        speed = self._speed(i) if self.table and self._counts_power(i) else EMPTY
        return Part((*part.lines, state, call, *speed.lines), part.counts + rates + speed.counts)

    def _moved_by_q(self, slip: str, share: sp.Expr) -> sp.Expr:
        weight, start = self.changes[SLIPS[slip]].coeff(s.DQ) * share, symbol(f"at.{slip}")
        return self._add(weight, H, start) if weight != 0 else start

    def _moved_by_last(self, slip: str, base: sp.Expr, weight: Fraction, stage: int) -> sp.Expr:
        """The latest impulses last, since they are known last."""
        change, total = self.changes[SLIPS[slip]], base
        for name, of in self.impulses.items():
            share = change.coeff(of) * rational(weight)
            if share != 0:
                total = self._add(share, rate(stage, name), total)
        return total

    def kept(self) -> tuple[Kept, ...]:
        """What each stage of a step with a table leaves, from that at its start on."""
        last = self.tableau.stages - 1
        stages = [Kept((), ("k0",), (), ("v0", "per_h", "j0"))]
        for i, row in enumerate(self.tableau.rows[1 : last + 1], 1):
            counts = self._counts_power(i)
            uses = [f"k{j}" for j, weight in enumerate(row) if weight] + ["v0"] * counts
            numbers = (f"j{i}",) if counts else ()
            stages.append(Kept(tuple(uses), (f"k{i}",), (), numbers))
        sums = tuple(f"sum{last}_{name}" for name in self.impulses)
        end = Kept(stages[-1].uses, (f"k{last}",), (f"y{last}",), (f"v{last}", f"j{last}", *sums))
        return (*stages[:-1], end)

    def _counts_power(self, i: int) -> bool:
        """Does the power of table friction at stage i enter the work or an interpolant?"""
        rows = (self.tableau.b, *self.tableau.dense)
        return i == self.tableau.stages - 1 or any(i < len(row) and row[i] != 0 for row in rows)

    def _speed(self, i: int) -> Part:
        """Approach velocity at stage i, and the work of table friction j = v t_y there."""
        driven = self._add(2 * rational(self.tableau.c[i]), H, symbol("v0"))
        approach = self.changes[s.V_N].coeff(s.T2Y)
        rubbed = symbol(f"sum{i}_t_y")
        value = self._add(approach, rubbed, driven)
        power = symbol(f"v{i}") * rate(i, "t_y")
        return self._part([Assign(f"v{i}", value, KIND), Assign(f"j{i}", power, KIND)])

    def extra_stages(self) -> tuple[Part, ...]:
        """The stages that only the interpolant needs."""
        counts = self._rates().counts
        total = len(self.tableau.rows)
        return tuple(self._stage(i, counts) for i in range(self.tableau.stages, total))
