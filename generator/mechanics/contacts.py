"""Slips at contacts, and what impulses there do to a solid sphere.

A slip is v + w x r at a contact. An impulse J at the point r changes v by J/m and w by (r x J)/I
with I = 2/5 m R^2. Lengths are in units of R, so that w x r is in m/s when w is carried as a spin
speed R w; impulses are divided by the mass, so they are in m/s too.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy as sp

INERTIA = sp.Rational(2, 5)  # solid sphere, in units of m R^2
TOP = sp.Matrix([0, 0, 1])  # from the centre, in units of R
BOTTOM = -TOP


@dataclass(frozen=True)
class Contact:
    """A point of a sphere, from its centre, and the impulse that it gets there."""

    point: sp.Matrix
    impulse: sp.Matrix


def slip_at(velocity: sp.Matrix, spin: sp.Matrix, point: sp.Matrix) -> sp.Matrix:
    """Velocity of a surface point: v + w x r."""
    return velocity + spin.cross(point)


def velocity_change(contacts: Iterable[Contact]) -> sp.Matrix:
    """Change of the velocity of the centre."""
    return sum((contact.impulse for contact in contacts), sp.zeros(3, 1))


def spin_change(contacts: Iterable[Contact]) -> sp.Matrix:
    """Change of the spin speed R w."""
    changes = (contact.point.cross(contact.impulse) / INERTIA for contact in contacts)
    return sum(changes, sp.zeros(3, 1))
