"""Masses of the two balls relative to the mass in whose units impulses are carried."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp

from generator.mechanics import symbols as s
from generator.mechanics.reduced import reduced_system
from generator.mechanics.terms import ContactTerms


@dataclass(frozen=True)
class Masses:
    """Inverse masses beta_i = M / M_i. M is twice the reduced mass, so that beta_1 + beta_2 = 2.

    Then v_n changes by 2 dq but for table friction and c_x by 7 d_x, as between equal balls.
    """

    beta1: sp.Rational
    beta2: sp.Rational

    @property
    def equal(self) -> bool:
        return bool(self.beta1 == self.beta2)

    def values(self) -> dict[sp.Symbol, sp.Expr]:
        return {s.BETA1: self.beta1, s.BETA2: self.beta2}

    def swapped(self) -> Masses:
        return Masses(self.beta2, self.beta1)


EQUAL = Masses(sp.Integer(1), sp.Integer(1))


def masses_of(ratio: float) -> Masses:
    """For a ball 1 that is `ratio` times as heavy as ball 2, taken as the decimal given."""
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
