"""Lowering of the exact steppers: one adaptive Runge-Kutta step of the reduced system.

The normal impulse q (divided by M, in m/s) is the independent variable; the impulse sums D (ball
against ball) and T (table) are the state. SymPy gives the slips as linear forms in the sums, the
tableau gives the stages; everything is printed in the lane vocabulary.
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

# Increments per dq, and their sums, in the order in which they are carried.
RATES = ("d_x", "d_z", "t_x", "t_y")
KIND = "const Real"
H = sp.Symbol("h", real=True)


def _symbol(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


@dataclass(frozen=True)
class ExactStep:
    """The parts of one step, printed."""

    slips: Part  # c_x..s_y from the sums at the start of an iteration
    slips_again: Part  # the same, assigned anew after a landing
    stages: tuple[Part, ...]
    error: Part
    step: Part  # sums, work and speed after the step, if it is accepted
    counts: OperationCounts  # of one step, without control


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

    def slip_forms(self, sums: dict[str, sp.Symbol]) -> list[tuple[str, sp.Expr]]:
        """Slips as starting value plus the linear form of the sums."""
        values = {
            s.DQ: sums["q"],
            s.D_X: sums["d_x"],
            s.D_Z: sums["d_z"],
            s.T2X: sums["t_x"],
            s.T2Y: sums["t_y"],
        }
        starts = {s.C_X: "c_x", s.C_Z: "c_z", s.S2X: "s_x", s.S2Y: "s_y"}
        return [
            (name, _symbol(f"start.{name}") + self.changes[slip].subs(values))
            for slip, name in starts.items()
        ]

    def parts(self) -> ExactStep:
        now = {name: _symbol(f"at.{name}") for name in ("q", *RATES)}
        slips = self._part([Assign(n, f, "Real") for n, f in self.slip_forms(now)])
        again = self._part([Assign(n, f) for n, f in self.slip_forms(now)])
        stages = tuple(self._stage(i) for i in range(1, self.tableau.stages))
        error, step = self._error(), self._step()
        total = error.counts + step.counts
        for stage in stages:
            total = total + stage.counts
        return ExactStep(slips, again, stages, error, step, total)

    # -- stages --

    def _stage(self, i: int) -> Part:
        """Sums at stage i, its slips, and the rates there by `rates_at`."""
        last = max(j for j, w in enumerate(self.tableau.a[i]) if w != 0)
        weight = self.tableau.a[i][last]
        reach = _symbol(f"h{i}")
        assigns, sums = [Assign(reach.name, _rational(weight) * H, KIND)], {}
        for name in RATES:
            early = [(w, _rate(j, name)) for j, w in enumerate(self.tableau.a[i][:last]) if w != 0]
            start = _symbol(f"at.{name}")
            ready = self._move(start, H, early) if early else start
            label = f"y{i}_{name}"
            assigns.append(Assign(label, self._add(reach, _rate(last, name), ready), KIND))
            sums[name] = _symbol(label)
        c = self.tableau.c[i]
        assigns.append(Assign(f"y{i}_q", self._add(H, _rational(c), _symbol("at.q")), KIND))
        sums["q"] = _symbol(f"y{i}_q")
        for name, form in self.slip_forms(sums):
            assigns.append(Assign(f"{name}{i}", form, KIND))
        part = self._part(assigns)
        slips = ", ".join(f"{name}{i}" for name in ("c_x", "c_z", "s_x", "s_y"))
        call = f"const Rates k{i} = rates_at(start, {slips});"
        return Part((*part.lines, call), part.counts + self.rates_counts())

    def rates_counts(self) -> OperationCounts:
        """Operations of `rates_at` (without the roots' own Newton steps)."""
        squares = OperationCounts(mul=2, fma=2) if self.place_fma else OperationCounts(mul=4, add=2)
        return squares + OperationCounts(mul=8)

    def _add(self, a: sp.Expr, b: sp.Expr, c: sp.Expr) -> sp.Expr:
        """a * b + c in this order."""
        return Fma(a, b, c) if self.place_fma else Plus(c, a * b)

    def _move(
        self, start: sp.Expr, h: sp.Symbol, weights: Sequence[tuple[Fraction, sp.Symbol]]
    ) -> sp.Expr:
        """start + h * (sum of weights)."""
        return self._add(h, _ordered_sum(weights, self.place_fma), start)

    # -- end of a step --

    def _error(self) -> Part:
        """Difference to the embedded method, for each sum, per unit of h."""
        assigns = []
        for name in RATES:
            weights = [(w, _rate(j, name)) for j, w in enumerate(self.tableau.error) if w != 0]
            assigns.append(Assign(f"e_{name}", _ordered_sum(weights, self.place_fma), KIND))
        return self._part(assigns)

    def _step(self) -> Part:
        """The double integral of t_y over the step, per h^2: what table friction adds to the work."""
        weights = [
            (w, _rate(j, "t_y")) for j, w in enumerate(self.tableau.double_weights) if w != 0
        ]
        return self._part([Assign("t_yy", _ordered_sum(weights, self.place_fma), KIND)])

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
