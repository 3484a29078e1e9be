"""The reduced loop: three slips with v_y as independent variable, and what follows from them.

Slips are linear in the velocities and rates linear in friction, so the slips obey a linear system
with constant coefficients. s_y = c_z + (1 + S) v_y always, so c_x, c_z and s_x are enough while
v_y falls; v and w come back from the changes of the slips. No impulse is summed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

import sympy as sp

from ...mechanics.linear import change_of
from . import symbols as s
from .contact import reduce_angle, slips, velocity_rates

_SLIPS = (s.C_X, s.C_Z, s.S_X, s.S_Y)


@cache
def slip_rates() -> Mapping[sp.Symbol, sp.Expr]:
    """Rates of the four slips per q, as forms in friction."""
    rates = velocity_rates()
    found = {name: reduce_angle(change_of(form, rates)) for name, form in slips().items()}
    return MappingProxyType(found)


def table_slip_y() -> sp.Expr:
    """s_y from c_z and v_y: the same in every state."""
    forms = slips()
    return sp.expand(s.C_Z + sp.factor(forms[s.S_Y] - forms[s.C_Z]))


def rolling_spin() -> sp.Expr:
    """o_x from c_z and v_y: the same in every state."""
    return sp.expand(sp.solve(sp.Eq(slips()[s.C_Z], s.C_Z), s.O_X)[0])


@dataclass(frozen=True)
class Stuck:
    """Friction of a contact that does not slip, from what the other contact's friction is."""

    friction: Mapping[sp.Symbol, sp.Expr]
    force: sp.Expr  # N


@cache
def stuck_cushion() -> Stuck:
    """c_x' = c_z' = 0 while the table slips along es: d_x, d_z and N.

    The table's friction is -u_s N es, and N depends on d_z: a linear system for both.
    """
    table = {s.T_X: -s.U_S * s.N * s.ES_X, s.T_Y: -s.U_S * s.N * s.ES_Y}
    rates = slip_rates()
    rows = [rates[name].subs(table) for name in (s.C_X, s.C_Z)]
    rows.append(s.N - (s.SIN - s.COS * s.D_Z))
    solved = sp.solve(rows, (s.D_X, s.D_Z, s.N), dict=True)[0]
    forms = {key: _simplified(form) for key, form in solved.items()}
    return Stuck(MappingProxyType({k: forms[k] for k in (s.D_X, s.D_Z)}), forms[s.N])


@cache
def stuck_table() -> Mapping[sp.Symbol, sp.Expr]:
    """s_x' = s_y' = 0 while the cushion slips: t_x and t_y."""
    rates = slip_rates()
    solved = sp.solve([rates[s.S_X], rates[s.S_Y]], (s.T_X, s.T_Y), dict=True)[0]
    return MappingProxyType({key: sp.expand(form) for key, form in solved.items()})


def _simplified(form: sp.Expr) -> sp.Expr:
    top, bottom = sp.fraction(sp.together(form))
    return sp.factor(reduce_angle(top)) / reduce_angle(bottom)


D_SLIPS = sp.symbols("dc_x dc_z ds_x dv_y", real=True)


@cache
def recovery() -> Mapping[sp.Symbol, sp.Expr]:
    """Changes of the velocities from the changes of c_x, c_z, s_x and v_y."""
    rates, (dc_x, dc_z, ds_x, dv_y) = slip_rates(), D_SLIPS
    sums = sp.solve([rates[s.C_X] - dc_x, rates[s.S_X] - ds_x], (s.D_X, s.T_X), dict=True)[0]
    along = {v: velocity_rates()[v].subs(sums) for v in (s.V_X, s.O_Y, s.O_Z)}
    changes = {v: _simplified(form) for v, form in along.items()}
    changes[s.V_Y] = dv_y
    changes[s.O_X] = rolling_spin().subs({s.C_Z: dc_z, s.V_Y: dv_y})
    return MappingProxyType({v: changes[v] for v in s.VELOCITIES})
