"""Contact points, slips and velocity updates, from first principles.

Source: Mathavan, Jackson, Parkin, Sports Engineering 17 (2014), Eqs. 3-11. What holds at any
contact of a ball is in `mechanics`.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from ...mechanics.contacts import BOTTOM, TOP, Contact, slip_at, spin_change, velocity_change
from . import symbols as s
from .terms import ContactTerms

TO_BALL_2 = sp.Matrix([0, 1, 0])  # contact point on ball 1, from its centre, in units of R
TO_BALL_1 = -TO_BALL_2


@dataclass(frozen=True)
class Slips:
    """Slip speeds as expressions in the ten (with lift twelve) velocities, m/s."""

    c_x: sp.Expr
    c_z: sp.Expr
    s1x: sp.Expr
    s1y: sp.Expr
    s2x: sp.Expr
    s2y: sp.Expr
    v_n: sp.Expr

    def items(self) -> list[tuple[sp.Symbol, sp.Expr]]:
        names = (s.C_X, s.C_Z, s.S1X, s.S1Y, s.S2X, s.S2Y, s.V_N)
        values = (self.c_x, self.c_z, self.s1x, self.s1y, self.s2x, self.s2y, self.v_n)
        return list(zip(names, values, strict=True))


def slips(terms: ContactTerms) -> Slips:
    """Contact slip, table slips and approach velocity of two balls."""
    contact = slip_at(s.V1, s.O1, TO_BALL_2) - slip_at(s.V2, s.O2, TO_BALL_1)
    c_z = contact[2]
    if not terms.lift:
        c_z = c_z.subs({s.V1[2]: 0, s.V2[2]: 0})
    table_point = BOTTOM if terms.table_slip_point == "bottom" else TOP
    table1 = slip_at(s.V1, s.O1, table_point)
    table2 = slip_at(s.V2, s.O2, table_point)
    v_n = s.V2[1] - s.V1[1]
    return Slips(contact[0], c_z, table1[0], table1[1], table2[0], table2[1], v_n)


def velocity_changes() -> dict[sp.Symbol, sp.Expr]:
    """Changes of all velocities for one increment of impulse, for unequal masses too.

    The vertical part of the contact impulse presses one ball onto the table, whose reaction then
    cancels it; the other ball is lifted by it. That part is `lift_changes`.
    """
    contact1 = sp.Matrix([s.D_X, -s.DQ, s.D_Z])
    table1 = sp.Matrix([s.T1X, s.T1Y, 0])
    table2 = sp.Matrix([s.T2X, s.T2Y, 0])
    changes: dict[sp.Symbol, sp.Expr] = {}
    for velocity, spin, beta, contact, point, table in (
        (s.V1, s.O1, s.BETA1, contact1, TO_BALL_2, table1),
        (s.V2, s.O2, s.BETA2, -contact1, TO_BALL_1, table2),
    ):
        contacts = Contact(point, contact), Contact(BOTTOM, table)
        linear = beta * velocity_change(contacts)
        angular = beta * spin_change(contacts)
        for axis in (0, 1):
            changes[velocity[axis]] = sp.expand(linear[axis])
        for axis in range(3):
            changes[spin[axis]] = sp.expand(angular[axis])
    return changes


def lift_changes(pressed: int) -> dict[sp.Symbol, sp.Expr]:
    """Vertical velocity gained by the lifted ball while the other one is pressed."""
    if pressed == 2:
        return {s.V1[2]: s.BETA1 * s.D_Z, s.V2[2]: sp.Integer(0)}
    return {s.V1[2]: sp.Integer(0), s.V2[2]: -s.BETA2 * s.D_Z}
