"""Reduced states as a ball, such that the doubles of the case give the wanted slips again."""

from __future__ import annotations

import numpy as np

from ....evidence.verification.errors import Array
from ..columns import COLUMNS
from ..evidence import cases_for_scene
from .charts import Layout, States
from .envelope import REAL_SPEED, REAL_SPIN, Envelope
from .rewind import C_X, C_Z, S_X

_VX, _WX, _NX = (COLUMNS.case.index(name) for name in ("vx", "wx", "nx"))


def cases_of(states: States, layout: Layout, within: Envelope) -> Array:
    """Rows of cases: v_y = 1 times the layout's speed, and spins that give the slips."""
    sine, cosine = states.friction.sine, states.friction.cosine
    c_x, c_z, s_x = states.slips[C_X], states.slips[C_Z], states.slips[S_X]
    one, none = np.ones_like(c_x), np.zeros_like(c_x)
    o_y = states.along - s_x
    o_z = (states.along + sine * o_y - c_x) / cosine
    speed = np.stack([states.along, one, none])
    spin = np.stack([c_z + sine, o_y, o_z])
    scale = layout.speed * one
    if within.extent == "real":
        fast, spun = np.linalg.norm(speed, axis=0), np.linalg.norm(spin, axis=0)
        scale = np.minimum(scale, np.minimum(REAL_SPEED / fast, REAL_SPIN / (spun + 1e-300)))
    rows = np.zeros((len(c_x), len(COLUMNS.case)))
    rows[:, 0], rows[:, 1] = within.radius, within.mass
    given = (states.friction.u_s, states.friction.u_w, states.e_c, within.radius * (1 + sine))
    rows[:, 2:6] = np.stack(given, axis=-1)
    turn = _rotation(layout.angle)
    for first, vector, per in ((_VX, speed, 1.0), (_WX, spin, within.radius)):
        turned = vector * scale / per
        turned[:2] = turn @ turned[:2]
        rows[:, first : first + 3] = turned.T
    rows[:, _NX : _NX + 2] = turn @ np.array([0.0, 1.0])
    return rows if within.scene.unrestricted else cases_for_scene(within.scene, rows)


def _rotation(angle: float) -> Array:
    c, s = (1.0, 0.0) if angle == 0 else (np.cos(angle), np.sin(angle))
    return np.array([[c, -s], [s, c]])
