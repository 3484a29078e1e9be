"""The symbols of the model, one name each, as in Mathavan, Jackson, Parkin (2010).

Spins are carried as speeds, o = R w in m/s, and impulses too, q = P / M in m/s: so neither the
radius nor the mass is left in an equation. Rates are per q, the normal impulse at the cushion.
"""

from __future__ import annotations

import sympy as sp


def _real(names: str) -> tuple[sp.Symbol, ...]:
    made: tuple[sp.Symbol, ...] = sp.symbols(names, real=True)
    return made


# y is the normal into the cushion, z points up, x = (n_y, -n_x): right-handed.
V_X, V_Y = _real("v_x v_y")  # of the centre, m/s; the table keeps v_z at 0
O_X, O_Y, O_Z = _real("o_x o_y o_z")  # R times the angular velocity, m/s
VELOCITIES = (V_X, V_Y, O_X, O_Y, O_Z)

# The nose touches the ball at the angle theta above its centre.
SIN, COS = sp.Symbol("S", real=True), sp.Symbol("C", positive=True)

# Friction for each unit of q: of the cushion along x and up its face, of the table along x and y.
D_X, D_Z, T_X, T_Y = _real("d_x d_z t_x t_y")
N = sp.Symbol("N", real=True)  # force of the table, as a share of the cushion's

# Slips at the cushion and on the table, m/s.
C_X, C_Z, S_X, S_Y = _real("c_x c_z s_x s_y")
WORK = sp.Symbol("W", nonnegative=True)  # of the normal impulse at the cushion, by M: m^2/s^2

# Unit vectors of the slips.
EC_X, EC_Z, ES_X, ES_Y = _real("ec_x ec_z es_x es_y")

# Parameters.
U_S, U_W, E_C, R, M, H = sp.symbols("u_s u_w e_c R M h", nonnegative=True)
