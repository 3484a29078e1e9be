"""The reduced system: only the slips and the approach velocity are needed inside the loop.

Every slip is linear in the velocities and every velocity change is linear in the impulses, so the
slips obey a linear system with constant coefficients; the impulse sums follow from the changes of
the slips, and the velocities from the sums. SymPy does both steps with exact rationals,
once for each model: many kernels are made from the same few systems.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

import sympy as sp

from ...mechanics.linear import change_of, sums_from
from . import symbols as s
from .contact import lift_changes, slips, velocity_changes
from .terms import ContactTerms

EQUAL_MASSES = {s.BETA1: sp.Integer(1), s.BETA2: sp.Integer(1)}


@dataclass(frozen=True)
class ReducedSystem:
    """Changes of the seven slips per increment, as linear forms in dq, d_x, d_z, t1, t2."""

    terms: ContactTerms
    pressed: int
    changes: Mapping[sp.Symbol, sp.Expr]

    def coefficient(self, state: sp.Symbol, impulse: sp.Symbol) -> sp.Expr:
        return sp.expand(self.changes[state]).coeff(impulse)


@cache
def reduced_system(terms: ContactTerms, pressed: int, equal: bool = True) -> ReducedSystem:
    """Derive the reduced system for the case that ball `pressed` (1 or 2) touches the table."""
    deltas = velocity_changes()
    deltas.update(lift_changes(pressed))
    idle = (s.T1X, s.T1Y) if pressed == 2 else (s.T2X, s.T2Y)
    nothing = {symbol: sp.Integer(0) for symbol in idle}
    changes = {}
    for name, form in slips(terms).items():
        change = sp.expand(change_of(form, deltas).subs(nothing))
        changes[name] = change.subs(EQUAL_MASSES) if equal else change
    return ReducedSystem(terms, pressed, MappingProxyType(changes))


def drives_its_slip(terms: ContactTerms) -> bool:
    """Does friction on the table drive the slip that it comes from away from zero?"""
    return bool(reduced_system(terms, 2).coefficient(s.S2X, s.T2X) < 0)


@dataclass(frozen=True)
class Recovery:
    """Impulse sums as linear forms in the changes of the pressed ball's slips."""

    sums: Mapping[sp.Symbol, sp.Expr]  # q_sum, sum_dx, sum_dz, sum_tx, sum_ty of the pressed ball
    deltas: tuple[sp.Symbol, ...]  # dc_x, dc_z, ds_x, ds_y, dv_n


DELTAS = sp.symbols("dc_x dc_z ds_x ds_y dv_n", real=True)


@cache
def recovery(terms: ContactTerms, pressed: int, equal: bool = True) -> Recovery:
    """Solve the linear system for the five impulse sums of a collision with one pressed ball."""
    system = reduced_system(terms, pressed, equal)
    table = (s.T2X, s.T2Y) if pressed == 2 else (s.T1X, s.T1Y)
    slip = (s.S2X, s.S2Y) if pressed == 2 else (s.S1X, s.S1Y)
    unknowns = (s.DQ, s.D_X, s.D_Z, *table)
    rows = [system.changes[name] for name in (s.C_X, s.C_Z, *slip, s.V_N)]
    return Recovery(MappingProxyType(sums_from(rows, unknowns, DELTAS)), DELTAS)


DELTAS_BOTH = sp.symbols("dc_x dc_z ds1x ds1y ds2x ds2y dv_n", real=True)


@cache
def recovery_both(terms: ContactTerms) -> Mapping[sp.Symbol, sp.Expr]:
    """Impulse sums where either ball was pressed in turn: seven sums from seven slips."""
    one, two = (reduced_system(terms, pressed).changes for pressed in (1, 2))
    unknowns = (s.DQ, s.D_X, s.D_Z, s.T1X, s.T1Y, s.T2X, s.T2Y)
    names = (s.C_X, s.C_Z, s.S1X, s.S1Y, s.S2X, s.S2Y, s.V_N)
    rows = [merge_pressed(one[name], two[name]) for name in names]
    return MappingProxyType(sums_from(rows, unknowns, DELTAS_BOTH))


def merge_pressed(one: sp.Expr, two: sp.Expr) -> sp.Expr:
    """One form for both pressed cases: they agree but for table terms, of which one is zero."""
    table1 = sum((one.coeff(t) * t for t in (s.T1X, s.T1Y)), sp.Integer(0))
    table2 = sum((two.coeff(t) * t for t in (s.T2X, s.T2Y)), sp.Integer(0))
    common = sp.expand(one - table1)
    if sp.expand(common - (two - table2)) != 0:
        raise ValueError("the pressed cases differ beyond their table terms")
    return common + table1 + table2
