"""The symbols of the model, one name each, as in Mathavan, Jackson, Parkin (2014).

Spins are carried as speeds: o = R*w in m/s, so the radius drops out of every equation below.
Impulses are carried as speeds too: dq = dP/M in m/s, so the mass drops out for equal balls.
"""

from __future__ import annotations

import sympy as sp

AXES = ("x", "y", "z")


def _real(names: str) -> tuple[sp.Symbol, ...]:
    made: tuple[sp.Symbol, ...] = sp.symbols(names, real=True)
    return made


# Linear velocities and spin speeds of ball 1 and ball 2 in the contact frame (r, f, u) = (x, y, z).
V1 = sp.Matrix(_real("v1x v1y v1z"))
V2 = sp.Matrix(_real("v2x v2y v2z"))
O1 = sp.Matrix(_real("o1x o1y o1z"))
O2 = sp.Matrix(_real("o2x o2y o2z"))

# One increment of normal impulse and what friction makes of it, all divided by the mass (m/s).
DQ = sp.Symbol("dq", positive=True)
D_X, D_Z = _real("d_x d_z")  # ball-ball friction on ball 1 along x and z
T1X, T1Y = _real("t1x t1y")  # table friction on ball 1 along x and y
T2X, T2Y = _real("t2x t2y")  # table friction on ball 2 along x and y

# Reduced state: contact slip, table slips, approach velocity.
C_X, C_Z = _real("c_x c_z")
S1X, S1Y = _real("s1x s1y")
S2X, S2Y = _real("s2x s2y")
V_N = sp.Symbol("v_n", real=True)

# Inverse masses relative to the unit of impulse: beta_i = M / M_i (1 for equal balls).
BETA1, BETA2 = sp.symbols("beta1 beta2", positive=True)

# Parameters.
U_B, U_S1, U_S2, E_B, R, M = sp.symbols("u_b u_s1 u_s2 e_b R M", nonnegative=True)
