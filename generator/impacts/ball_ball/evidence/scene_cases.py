"""Cases that lie inside a scene, made from cases of the whole envelope."""

from __future__ import annotations

import numpy as np

from ....evidence.verification.errors import Array
from ....evidence.verification.scene_ranges import SPREAD, into, move_parameters
from ..columns import COLUMNS
from ..columns import V1 as _V1
from ..columns import V2 as _V2
from ..columns import W1 as _W1
from ..columns import W2 as _W2
from ..models import find_model
from ..parameters import CASE_M1
from ..scene import ALCIATORE, Scene
from ..terms import MASS_RATIOS
from .measure import relative_speed

_V_Z = (_V1.stop - 1, _V2.stop - 1)
_INSIDE = 1e-9  # keep as much away from the bounds of a range of speeds, of the bound


def cases_for_scene(scene: Scene, rows: Array, model: str | None = None) -> Array:
    """The cases, changed where they lie outside the scene; one row for each that is given.

    Balls still touch and approach. `model`: whose contact slip a friction law takes, if not that of
    the scene.
    """
    cases = np.array(rows, dtype=np.float64, copy=True)
    _motions(scene, cases)
    move_parameters(cases, COLUMNS, scene)
    if scene.masses_given:
        cases[:, 1] = _spread_masses(cases[:, 1])
    if not scene.table_friction:
        cases[:, 2:4] = 0.0
    if scene.equal_table:
        cases[:, 3] = cases[:, 2]
    _speeds(scene, cases)
    if scene.friction_law == "alciatore":
        cases[:, 4] = alciatore(contact_slip(cases, model or scene.model))
    return cases


def mass_ratios(scene: Scene, cases: Array) -> float | Array:
    """Of ball 1 to ball 2, in every case."""
    return CASE_M1 / cases[:, 1] if scene.mass_ratio == "given" else scene.mass_ratio


def contact_slip(cases: Array, model: str) -> Array:
    """Contact slip speed before the collision in m/s."""
    d = cases[:, 15:17] - cases[:, 6:8]
    f = d / np.hypot(d[:, 0], d[:, 1])[:, None]
    r = np.column_stack([f[:, 1], -f[:, 0]])
    dv = cases[:, _V1] - cases[:, _V2]
    spin = cases[:, :1] * (cases[:, _W1] + cases[:, _W2])
    c_x = (dv[:, :2] * r).sum(axis=1) - spin[:, 2]
    c_z = (spin[:, :2] * r).sum(axis=1)
    if find_model(model).terms.lift:
        c_z = c_z + dv[:, 2]
    slip: Array = np.hypot(c_x, c_z)
    return slip


def alciatore(slip: Array) -> Array:
    a, b, c = ALCIATORE
    return a + b * np.exp(-c * slip)


def _spread_masses(values: Array) -> Array:
    """Masses of ball 2 that give every ratio, evenly in its logarithm."""
    low, high = np.log(MASS_RATIOS)
    place = np.abs(values * SPREAD) % 1.0
    spread: Array = CASE_M1 / np.exp(low + (high - low) * (_INSIDE + (1 - 2 * _INSIDE) * place))
    return spread


def _motions(scene: Scene, cases: Array) -> None:
    if scene.object_ball == "rest":
        cases[:, _V1] -= cases[:, _V2]
        cases[:, _V2] = cases[:, _W2] = 0.0
    for spin in (_W1, _W2):
        if scene.spin == "none":
            cases[:, spin] = 0.0
        if scene.spin == "side":
            cases[:, spin.start : spin.start + 2] = 0.0
    if scene.level:
        cases[:, _V_Z] = 0.0  # else a ball is pressed after all, with lift


def _speeds(scene: Scene, cases: Array) -> None:
    if scene.speed is not None:
        low, high = scene.speed
        speed = relative_speed(cases)
        wanted = np.clip(into(speed, low, high), low * (1 + _INSIDE), high * (1 - _INSIDE))
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = np.where(speed > 0, wanted / speed, 1.0)[:, None]
        for vector in (_V1, _W1, _V2, _W2):
            cases[:, vector] *= scale
    if scene.spin_speed is not None:
        for spin in (_W1, _W2):
            size = np.abs(cases[:, 0]) * np.linalg.norm(cases[:, spin], axis=1)
            most = scene.spin_speed * (1 - _INSIDE)
            with np.errstate(divide="ignore", invalid="ignore"):
                cases[:, spin] *= np.where(size > most, most / size, 1.0)[:, None]
