"""Reduced states as two balls, such that the doubles of the case give the wanted slips again."""

from __future__ import annotations

import numpy as np

from ....evidence.verification.errors import Array
from ..evidence.measure import CASE_COLUMNS
from ..evidence.scene_cases import cases_for_scene
from ..models import find_model
from .charts import Layout, States
from .envelope import REAL_SPEED, REAL_SPIN, Envelope
from .rewind import C_X, C_Z, S_X, S_Y

_ONE, _TWO = slice(6, 15), slice(15, 24)


def cases_of(states: States, layout: Layout, within: Envelope) -> Array:
    """Rows of 24. What no slip depends on is zero, so that nothing cancels that need not."""
    c_x, c_z, s_x, s_y = (states.slips[i] for i in (C_X, C_Z, S_X, S_Y))
    side = 1.0 if find_model(within.model).terms.table_slip_point == "top" else -1.0
    along = np.where(np.abs(s_y) > 1, 0.0, 0.0 if layout.spun else s_y)
    none = np.zeros_like(c_x)
    across = layout.moving * c_x
    spin2 = np.stack([-side * (s_y - along), side * s_x, none])
    spin1 = np.stack([c_z - spin2[0], none, across - c_x])
    speed1, speed2 = np.stack([across, along + 1, none]), np.stack([none, along, none])
    scale = layout.speed
    if within.extent == "real":
        fast = np.maximum(np.linalg.norm(speed1, axis=0), np.linalg.norm(speed2, axis=0))
        spun = np.maximum(np.linalg.norm(spin1, axis=0), np.linalg.norm(spin2, axis=0))
        scale = np.minimum(scale, np.minimum(REAL_SPEED / fast, REAL_SPIN / (spun + 1e-300)))
    rows = np.zeros((len(c_x), CASE_COLUMNS))
    rows[:, 0], rows[:, 1] = within.radius, within.mass
    rows[:, 2] = rows[:, 3] = states.u_s
    rows[:, 4], rows[:, 5] = states.u_b, states.e_b
    rows[:, [8, 17]] = within.radius
    turn = _rotation(layout.angle)
    rows[:, 15:17] = turn @ np.array([0.0, 2 * within.radius])
    for first, vector, per in ((9, speed1, 1.0), (12, spin1, within.radius)):
        rows[:, first : first + 3] = _turned(turn, vector * scale / per)
    for first, vector, per in ((18, speed2, 1.0), (21, spin2, within.radius)):
        rows[:, first : first + 3] = _turned(turn, vector * scale / per)
    if layout.pressed_first:
        rows[:, _ONE], rows[:, _TWO] = rows[:, _TWO].copy(), rows[:, _ONE].copy()
    return rows if within.scene.unrestricted else cases_for_scene(within.scene, rows, within.model)


def _rotation(angle: float) -> Array:
    c, s = (1.0, 0.0) if angle == 0 else (np.cos(angle), np.sin(angle))
    return np.array([[c, -s], [s, c]])


def _turned(turn: Array, vector: Array) -> Array:
    turned = np.array(vector)
    turned[:2] = turn @ vector[:2]
    return turned.T
