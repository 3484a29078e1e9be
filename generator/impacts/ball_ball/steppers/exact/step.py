"""Lowering of the exact steppers: one adaptive Runge-Kutta step of the reduced system.

The normal impulse q (divided by M, in m/s) is the independent variable and the slips are the state.
A stage adds up the friction impulses of the earlier ones, which change the slips beside q: SymPy
gives the slips that follow from them, linearly, and after the collision the impulse sums. The
tableau gives the stages. Everything is printed in the lane vocabulary.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from .....lowering.counts import OperationCounts
from .....lowering.statements import Assign, Part
from ... import symbols as s
from .stages import Stages
from .tail import TailText
from .writing import EMPTY, KIND, ordered_sum, rate, symbol


@dataclass(frozen=True)
class ExactStep:
    """The parts of one step, printed."""

    rates: Part  # impulses of friction for `pace` of q, from the slips and inverse lengths i_c, i_s
    stages: tuple[Part, ...]
    error: Part
    work: Part  # table friction's work over the step
    sums: Part  # impulse sums from the changes of the slips
    sums_of_slips: Part  # the same where the state is gone and its slips and q are left
    counts: OperationCounts  # of one step, without the roots and the control


class ExactLowering(Stages, TailText):
    """Prints the parts of a step."""

    def parts(self) -> ExactStep:
        rates = self._rates()
        stages = tuple(self._stage(i, rates.counts) for i in range(1, self.tableau.stages))
        error, work = self._error(), self._work()
        total = error.counts + work.counts
        for stage in stages:
            total = total + stage.counts
        total = total + self._laid_out()
        sums = self._sums("at.q"), self._sums("q")
        return ExactStep(rates, stages, error, work, *sums, total)

    def _laid_out(self) -> OperationCounts:
        """What templates/exact lays out around the printed parts of a step.

        Squares of slips, the pace, the first impulses, the size of the error.
        """
        added = OperationCounts(fma=1) if self.place_fma else OperationCounts(add=1, mul=1)
        evaluations = self.tableau.stages - 1
        if self.table:
            total = (added * 4 + OperationCounts(mul=1)) * evaluations
            total = total + added + OperationCounts(mul=11, div=1)
            weighed = self.changes[s.V_N].coeff(s.T2Y) != 1  # the work of the step
            total = total + OperationCounts(mul=1) * weighed
        else:
            total = (added * 2 + OperationCounts(mul=1)) * evaluations
            total = total + added + OperationCounts(mul=7, div=1)
        if self.tableau.second:
            joint = OperationCounts(add=1, mul=2, div=1, sqrt=1) + added
            total = total + joint + added * self.table
        return total

    def drift(self) -> Part:
        """b, the rate of change of the table slip at the start of a step."""
        names = (("b_x", "s_x"), ("b_y", "s_y"))
        forms = [(b, self._moved(slip, sp.Integer(0), "at.k.", sp.Integer(1))) for b, slip in names]
        return self._part([Assign(b, form, KIND) for b, form in forms])

    def landed(self) -> Part:
        """What the slips change by in a part of a step: from part_d_x, ..., and dq."""
        return self._part(
            [
                Assign(f"part_{n}", self._moved(n, sp.Integer(0), "part_", symbol("dq")), KIND)
                for n in self.slips
            ]
        )

    def _error(self) -> Part:
        """Differences to the embedded method in impulses, e_; to a coarser one, e3_."""
        sums = self._sums_of_rates(self.tableau.error, "e_")
        if self.tableau.second:
            sums += self._sums_of_rates(self.tableau.second_error, "e3_")
        return self._part(sums)

    def _work(self) -> Part:
        """Work of table friction over the step: it changes the square of v_n."""
        if not self.table:
            return EMPTY
        weights = [(w, symbol(f"j{j}")) for j, w in enumerate(self.tableau.b) if w != 0]
        return self._part([Assign("j_sum", ordered_sum(weights, self.place_fma), KIND)])

    def dense(self, names: Sequence[str]) -> Part:
        """Coefficients of the interpolant beyond the cubic: r<n>_<name> for each name."""
        assigns = []
        for n, row in enumerate(self.tableau.dense):
            for name in names:
                rates = [
                    (w, symbol(f"j{i}") if name == "j" else rate(i, name))
                    for i, w in enumerate(row)
                    if w != 0
                ]
                value = ordered_sum(rates, self.place_fma)
                assigns.append(Assign(f"r{n}_{name}", value, KIND))
        return self._part(assigns)

    def _sums(self, q: str) -> Part:
        """Impulse sums of the whole collision: added up, or from the changes of the slips."""
        if self.gains:
            return self._part([Assign(n, symbol(f"at.gain_{n}"), KIND) for n in self.impulses])
        assigns = [
            Assign(f"delta_{n}", symbol(f"at.{n}") - symbol(f"slips.{n}"), KIND) for n in self.slips
        ]
        deltas = {name: symbol(f"delta_{name}") for name in self.slips}
        for name, form in self._solved(deltas, symbol(q)).items():
            assigns.append(Assign(name, form, KIND))
        return self._part(assigns)

    def _solved(self, deltas: dict[str, sp.Symbol], q: sp.Expr) -> dict[str, sp.Expr]:
        """d_x, d_z, t_x, t_y that change the slips by `deltas` while the normal impulse is q."""
        unknowns = (s.D_X, s.D_Z, s.T2X, s.T2Y) if self.table else (s.D_X, s.D_Z)
        rows = [self.changes[slip] for slip in self.slips.values()]
        matrix = sp.Matrix([[row.coeff(u) for u in unknowns] for row in rows])
        right = sp.Matrix(
            [deltas[n] - row.coeff(s.DQ) * q for n, row in zip(self.slips, rows, strict=True)]
        )
        solution = matrix.LUsolve(right)
        names = ("d_x", "d_z", "t_x", "t_y")[: len(unknowns)]
        return {n: sp.expand(sp.cancel(v)) for n, v in zip(names, solution, strict=True)}
