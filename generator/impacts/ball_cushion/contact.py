"""Contact points, slips and velocity rates, from first principles.

What holds at any contact of a ball is in `mechanics`. The ball touches the cushion's nose at the
angle theta above its centre, sin theta = h/R - 1, and the table at its lowest point. Lengths are in
units of R.
Source: Mathavan, Jackson, Parkin, Proc. IMechE C 224 (2010) 1863-1873, Eqs. 3-14.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

import sympy as sp

from ...mechanics.contacts import BOTTOM, Contact, slip_at, spin_change, velocity_change
from . import symbols as s

ALONG = sp.Matrix([1, 0, 0])
NOSE = sp.Matrix([0, s.COS, s.SIN])  # from the centre; the cushion pushes the other way
FACE = sp.Matrix([0, -s.SIN, s.COS])  # up the cushion's face, at right angles to both

VELOCITY = sp.Matrix([s.V_X, s.V_Y, 0])
SPIN = sp.Matrix([s.O_X, s.O_Y, s.O_Z])


def reduce_angle(form: sp.Expr) -> sp.Expr:
    """Expanded, with C^2 = 1 - S^2."""
    form = sp.expand(form)
    while form.has(s.COS**2) or any(form.coeff(s.COS, n) != 0 for n in range(2, 5)):
        form = sp.expand(form.subs(s.COS**2, 1 - s.SIN**2))
    return form


@cache
def slips() -> Mapping[sp.Symbol, sp.Expr]:
    """The four slips as forms in the five velocities, m/s."""
    nose, table = (slip_at(VELOCITY, SPIN, point) for point in (NOSE, BOTTOM))
    forms = {
        s.C_X: nose.dot(ALONG),
        s.C_Z: nose.dot(FACE),
        s.S_X: table[0],
        s.S_Y: table[1],
    }
    return MappingProxyType({name: reduce_angle(form) for name, form in forms.items()})


def nose_impulse() -> sp.Matrix:
    """What the cushion gives for a unit of q: the push and its friction."""
    return -NOSE + s.D_X * ALONG + s.D_Z * FACE


def table_force() -> sp.Expr:
    """N for a unit of q: what keeps the centre level."""
    return -nose_impulse()[2]


@cache
def velocity_rates() -> Mapping[sp.Symbol, sp.Expr]:
    """Rates of all velocities per q, as forms in friction."""
    table = sp.Matrix([s.T_X, s.T_Y, 0])
    contacts = Contact(NOSE, nose_impulse()), Contact(BOTTOM, table)
    linear, angular = velocity_change(contacts), spin_change(contacts)
    rates = (linear[0], linear[1], *angular)
    named = zip(s.VELOCITIES, rates, strict=True)
    return MappingProxyType({velocity: reduce_angle(rate) for velocity, rate in named})


def work_rate() -> sp.Expr:
    """Rate of the normal impulse's work at the nose while the ball moves into the cushion."""
    return VELOCITY.dot(NOSE)
