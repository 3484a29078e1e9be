"""Masses of the two balls relative to the mass in whose units impulses are carried."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import sympy as sp

from . import symbols as s
from .reduced import reduced_system
from .terms import MASS_RATIOS, ContactTerms


@dataclass(frozen=True)
class Masses:
    """Inverse masses beta_i = M / M_i. M is twice the reduced mass, so that beta_1 + beta_2 = 2.

    Then v_n changes by 2 dq but for table friction and c_x by 7 d_x, as between equal balls.
    """

    beta1: sp.Expr
    beta2: sp.Expr

    @property
    def equal(self) -> bool:
        return bool(self.beta1 == self.beta2)

    def values(self) -> dict[sp.Symbol, sp.Expr]:
        return {s.BETA1: self.beta1, s.BETA2: self.beta2}

    def swapped(self) -> Masses:
        return Masses(self.beta2, self.beta1)


EQUAL = Masses(sp.Integer(1), sp.Integer(1))
MassRatio = float | Literal["given"]  # of ball 1 to ball 2; given: with the call
# Where the masses come with the call, as a kernel names their inverses: before and after the steps
# those of both balls, in the steps that of the pressed ball, from which the other's follows.
_BETA1, _BETA2, _PRESSED = (
    sp.Symbol(name, positive=True) for name in ("p.beta1", "p.beta2", "start.beta")
)
GIVEN, GIVEN_PRESSED = Masses(_BETA1, _BETA2), Masses(2 - _PRESSED, _PRESSED)
GIVEN_BETAS = tuple(2 * ratio / (1 + ratio) for ratio in MASS_RATIOS)  # between which that lies


def masses_of(ratio: MassRatio) -> Masses:
    """For a ball 1 that is `ratio` times as heavy as ball 2, taken as the decimal given."""
    if ratio == "given":
        return GIVEN
    exact = Fraction(repr(ratio))
    r = sp.Rational(exact.numerator, exact.denominator)
    return Masses(2 / (r + 1), 2 * r / (r + 1))


def pressed_changes(terms: ContactTerms, masses: Masses) -> Mapping[sp.Symbol, sp.Expr]:
    """Changes of the slips while ball 2 is pressed.

    For a pressed ball 1 the signs of s, t, c_z and d_z change and the masses change places; then
    the same system holds (a test derives both).
    """
    changes = reduced_system(terms, 2, equal=False).changes
    return {name: sp.expand(form.subs(masses.values())) for name, form in changes.items()}
