"""What all parts of an exact step are written with: equations, a tableau, and how it is printed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp

from .....lowering.chains import unfolded
from .....lowering.counts import OperationCounts
from .....lowering.printer import ExpressionPrinter, Fma, Plus
from .....lowering.statements import Assign, Part, lower
from .....tableaus.tableau import Tableau
from ... import symbols as s
from ...masses import EQUAL, Masses, pressed_changes
from ...terms import ContactTerms

# The slips that a step carries, in the order of struct Slips, and what they are in the mechanics;
# the friction impulses that change them, in the order of struct Rates.
SLIPS: dict[str, sp.Symbol] = {"c_x": s.C_X, "c_z": s.C_Z, "s_x": s.S2X, "s_y": s.S2Y}
IMPULSES: dict[str, sp.Symbol] = {"d_x": s.D_X, "d_z": s.D_Z, "t_x": s.T2X, "t_y": s.T2Y}
CONTACT, RUBBING = ("c_x", "c_z"), ("d_x", "d_z")  # all there is where there is no table friction
KIND = "const Real"
H = sp.Symbol("h", real=True)
EMPTY = Part((), OperationCounts())


def symbol(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


def rate(stage: int, name: str) -> sp.Symbol:
    return symbol(f"k{stage}.{name}")


def rational(weight: Fraction) -> sp.Rational:
    return sp.Rational(weight.numerator, weight.denominator)


def ordered_sum(weights: Sequence[tuple[Fraction, sp.Symbol]], place_fma: bool) -> sp.Expr:
    """w0 k0 + w1 k1 + ... in this order; zero where there is nothing to add."""
    if not weights:
        return sp.Integer(0)
    (first, rate), *rest = weights
    total: sp.Expr = rational(first) * rate
    for weight, rate in rest:
        w = rational(weight)
        total = Fma(w, rate, total) if place_fma else Plus(total, w * rate)
    return total


@dataclass(frozen=True)
class Equations:
    """Which equations are stepped: a contact model's, for a pair of masses.

    Ball 2 is the pressed one: with sigma = -1 for a pressed ball 1, the slips s, the table
    increments t, c_z and d_z times sigma obey the same system, with the masses in each other's
    place. Without a table only the contact slip is carried.
    """

    terms: ContactTerms
    masses: Masses = EQUAL
    table: bool = True


@dataclass(frozen=True)
class Writing:
    """How the parts of a step are written."""

    place_fma: bool
    gains: bool = False  # are impulses added up beside the slips, whose own rounding counts?
    lanes: bool = False  # as few operations as there can be; else a short chain between stages
    split_roots: bool = False  # goes what a root is multiplied by in before its last correction?


class StepText:
    """Prints what a step is made of, for one system of equations and a tableau."""

    def __init__(self, equations: Equations, tableau: Tableau, writing: Writing) -> None:
        self.tableau = tableau
        self.table = equations.table
        self.place_fma = writing.place_fma
        self.gains = writing.gains
        self.lanes = writing.lanes
        self.split_roots = writing.split_roots and self.table
        self.slips = SLIPS if self.table else {name: SLIPS[name] for name in CONTACT}
        self.impulses = IMPULSES if self.table else {name: IMPULSES[name] for name in RUBBING}
        self.printer = ExpressionPrinter(self.place_fma, fma_name="fma", number_format="real({})")
        self.changes = pressed_changes(equations.terms, equations.masses)

    def _moved(
        self, slip: str, base: sp.Expr, impulse: str, q: sp.Expr, share: int | sp.Expr = 1
    ) -> sp.Expr:
        """base + the change of a slip by the impulses `impulse` + name, and by a share of q."""
        change = self.changes[SLIPS[slip]]
        terms = [(change.coeff(s.DQ) * share, q)]
        terms += [(change.coeff(of), symbol(impulse + name)) for name, of in self.impulses.items()]
        total = base
        for weight, value in terms:
            if weight == 0:
                continue
            total = weight * value if total == 0 else self._add(weight, value, total)
        return total

    def _sums_of_rates(
        self, row: Sequence[Fraction], prefix: str, names: Sequence[str] = ()
    ) -> list[Assign]:
        """The impulses of a row of weights, as prefix + name."""
        return [
            Assign(
                prefix + name,
                ordered_sum([(w, rate(j, name)) for j, w in enumerate(row) if w], self.place_fma),
                KIND,
            )
            for name in names or self.impulses
        ]

    def _add(self, a: sp.Expr, b: sp.Expr, c: sp.Expr) -> sp.Expr:
        """a * b + c in this order."""
        return Fma(a, b, c) if self.place_fma else Plus(c, a * b)

    def _part(self, assigns: list[Assign]) -> Part:
        steps = [step for assign in assigns for step in unfolded(assign)]
        block = lower(steps, self.printer)
        return Part(tuple(block.lines), block.counts)
