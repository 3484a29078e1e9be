"""Lowering of the exact steppers: one adaptive Runge-Kutta step of the reduced system.

The normal impulse q (divided by M, in m/s) is the independent variable and the slips are the state;
SymPy gives their rates and, after the collision, the impulse sums. The tableau gives the stages.
Everything is printed in the lane vocabulary.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp

from generator.lowering.counts import OperationCounts
from generator.lowering.fixed_step import Part
from generator.lowering.printer import ExpressionPrinter, Fma, Plus
from generator.lowering.statements import Assign, lower
from generator.mechanics import symbols as s
from generator.mechanics.contact import ContactTerms
from generator.mechanics.reduced import reduced_system
from generator.steppers.tableaus import Tableau

# The slips that a step carries, in the order of struct Slips, and what they are in the mechanics.
SLIPS: dict[str, sp.Symbol] = {"c_x": s.C_X, "c_z": s.C_Z, "s_x": s.S2X, "s_y": s.S2Y}
RATES = (*SLIPS, "t_y")  # rates also hold that of table friction along y: it changes v_n
KIND = "const Real"
H = sp.Symbol("h", real=True)


def _symbol(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


@dataclass(frozen=True)
class ExactStep:
    """The parts of one step, printed."""

    rates: Part  # rates of the slips from the slips and the inverse lengths i_c, i_s
    stages: tuple[Part, ...]
    error: Part
    step: Part  # table friction's share of v_n and of the work
    sums: Part  # impulse sums from the changes of the slips
    counts: OperationCounts  # of one step, without the roots and the control


class ExactLowering:
    """Prints the parts of a step for one contact model and tableau.

    Ball 2 is the pressed one: with sigma = -1 for a pressed ball 1, the slips s, the table
    increments t, c_z and d_z times sigma obey the same system.
    """

    def __init__(self, terms: ContactTerms, tableau: Tableau, place_fma: bool) -> None:
        self.terms = terms
        self.tableau = tableau
        self.place_fma = place_fma
        self.printer = ExpressionPrinter(place_fma, fma_name="fma", number_format="real({})")
        self.changes = reduced_system(terms, 2).changes

    def parts(self) -> ExactStep:
        rates = self._rates()
        stages = tuple(self._stage(i, rates.counts) for i in range(1, self.tableau.stages))
        error, step = self._error(), self._step()
        total = error.counts + step.counts
        for stage in stages:
            total = total + stage.counts
        return ExactStep(rates, stages, error, step, self._sums(), total)

    # -- rates --

    def _rates(self) -> Part:
        """Rates with the inverse lengths multiplied in last, which keeps the critical chain short.

        p = -u_b c is contact friction times |c|, z = -u_s p_z s table friction times |c| |s|.
        """
        p_x, p_z, z_x, z_y, i_c, i_cs = (_symbol(n) for n in "p_x p_z z_x z_y i_c i_cs".split())
        u_b, u_s = _symbol("start.u_b"), _symbol("start.u_s")
        slips = {name: _symbol(f"at.{name}") for name in SLIPS}
        assigns = [
            Assign("p_x", -u_b * slips["c_x"], KIND),
            Assign("p_z", -u_b * slips["c_z"], KIND),
            Assign("g", -u_s * p_z, KIND),
            Assign("z_x", _symbol("g") * slips["s_x"], KIND),
            Assign("z_y", _symbol("g") * slips["s_y"], KIND),
            Assign("i_cs", i_c * _symbol("i_s"), KIND),
        ]
        for name, slip in SLIPS.items():
            change = self.changes[slip]
            contact = change.coeff(s.D_X) * p_x + change.coeff(s.D_Z) * p_z
            table = change.coeff(s.T2X) * z_x + change.coeff(s.T2Y) * z_y
            fixed = change.coeff(s.DQ)
            value = self._add(i_c, contact, fixed) if fixed != 0 else i_c * contact
            assigns.append(Assign(f"r_{name}", self._add(i_cs, table, value), KIND))
        assigns.append(Assign("r_t_y", i_cs * z_y, KIND))
        return self._part(assigns)

    # -- stages --

    def _stage(self, i: int, rates: OperationCounts) -> Part:
        """Slips at stage i, and the rates there by `rates_at`."""
        row = self.tableau.a[i]
        last = max(j for j, w in enumerate(row) if w != 0)
        reach = _symbol(f"h{i}")
        assigns = [Assign(reach.name, _rational(row[last]) * H, KIND)]
        for name in SLIPS:
            early = [(w, _rate(j, name)) for j, w in enumerate(row[:last]) if w != 0]
            start = _symbol(f"at.{name}")
            ready = self._add(H, _ordered_sum(early, self.place_fma), start) if early else start
            assigns.append(Assign(f"{name}{i}", self._add(reach, _rate(last, name), ready), KIND))
        part = self._part(assigns)
        slips = ", ".join(f"{name}{i}" for name in SLIPS)
        lines = (*part.lines, f"const Slips y{i} = {{{slips}}};")
        call = f"const Rates k{i} = rates_at(start, y{i});"
        return Part((*lines, call), part.counts + rates)

    def _add(self, a: sp.Expr, b: sp.Expr, c: sp.Expr) -> sp.Expr:
        """a * b + c in this order."""
        return Fma(a, b, c) if self.place_fma else Plus(c, a * b)

    # -- end of a step --

    def _error(self) -> Part:
        """Difference to the embedded method per unit of h, as impulse sums."""
        assigns = []
        for name in SLIPS:
            weights = [(w, _rate(j, name)) for j, w in enumerate(self.tableau.error) if w != 0]
            assigns.append(Assign(f"e_{name}", _ordered_sum(weights, self.place_fma), KIND))
        deltas = {name: _symbol(f"e_{name}") for name in SLIPS}
        for name, form in self._solved(deltas, sp.Integer(0)).items():
            assigns.append(Assign(f"e_{name}", form, KIND))
        return self._part(assigns)

    def _step(self) -> Part:
        """Integral and double integral of t_y over the step, per h and h^2."""
        assigns = []
        for label, row in (("t_mean", self.tableau.b), ("t_twice", self.tableau.double_weights)):
            weights = [(w, _rate(j, "t_y")) for j, w in enumerate(row) if w != 0]
            assigns.append(Assign(label, _ordered_sum(weights, self.place_fma), KIND))
        return self._part(assigns)

    def _sums(self) -> Part:
        """Impulse sums of the whole collision from the changes of the slips."""
        assigns = [
            Assign(f"delta_{n}", _symbol(f"at.{n}") - _symbol(f"start.{n}"), KIND) for n in SLIPS
        ]
        deltas = {name: _symbol(f"delta_{name}") for name in SLIPS}
        for name, form in self._solved(deltas, _symbol("at.q")).items():
            assigns.append(Assign(name, form, KIND))
        return self._part(assigns)

    def _solved(self, deltas: dict[str, sp.Symbol], q: sp.Expr) -> dict[str, sp.Expr]:
        """d_x, d_z, t_x, t_y that change the slips by `deltas` while the normal impulse is q."""
        unknowns = (s.D_X, s.D_Z, s.T2X, s.T2Y)
        rows = [self.changes[slip] for slip in SLIPS.values()]
        matrix = sp.Matrix([[row.coeff(u) for u in unknowns] for row in rows])
        right = sp.Matrix(
            [deltas[n] - row.coeff(s.DQ) * q for n, row in zip(SLIPS, rows, strict=True)]
        )
        solution = matrix.LUsolve(right)
        names = ("d_x", "d_z", "t_x", "t_y")
        return {n: sp.expand(sp.cancel(v)) for n, v in zip(names, solution, strict=True)}

    def _part(self, assigns: list[Assign]) -> Part:
        block = lower(assigns, self.printer)
        return Part(tuple(block.lines), block.counts)


def _rate(stage: int, name: str) -> sp.Symbol:
    return _symbol(f"k{stage}.{name}")


def _rational(weight: Fraction) -> sp.Rational:
    return sp.Rational(weight.numerator, weight.denominator)


def _ordered_sum(weights: Sequence[tuple[Fraction, sp.Symbol]], place_fma: bool) -> sp.Expr:
    """w0 k0 + w1 k1 + ... in this order."""
    (first, rate), *rest = weights
    total: sp.Expr = _rational(first) * rate
    for weight, rate in rest:
        w = _rational(weight)
        total = Fma(w, rate, total) if place_fma else Plus(total, w * rate)
    return total
