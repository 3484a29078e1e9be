"""What errors of two balls are relative to, and how fast the balls approach."""

from __future__ import annotations

import numpy as np

from ....evidence.verification.errors import Array, Errors, Measure
from ..columns import COLUMNS, R1, R2, V1, V2

CASE_COLUMNS, OUTCOME_COLUMNS = len(COLUMNS.case), COLUMNS.outcome_width
EXPECTED_COLUMNS, VELOCITIES = COLUMNS.expected_width, len(COLUMNS.velocities)
STATUS, STICKS = COLUMNS.status, COLUMNS.sticks
CASE_NAMES, OUTCOME_NAMES = COLUMNS.case, COLUMNS.velocities


def relative_speed(cases: Array) -> Array:
    """|v1 - v2| before the collision, m/s."""
    with np.errstate(invalid="ignore", over="ignore"):
        speed: Array = np.linalg.norm(cases[:, V1] - cases[:, V2], axis=1)
        return speed


def approach_speed(cases: Array) -> Array:
    """|v_n| before the collision: speed along the level line of centres, m/s; 0 if undefined."""
    d, dv = cases[:, R2] - cases[:, R1], cases[:, V2] - cases[:, V1]
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        normal = np.abs((d * dv)[:, :2].sum(axis=1)) / np.hypot(d[:, 0], d[:, 1])
    return np.where(np.isfinite(normal), normal, 0.0)


MEASURE = Measure(COLUMNS, relative_speed)
SPEEDS = MEASURE.moving  # columns of a case


def errors_of(cases: Array, got: Array, want: Array) -> Errors:
    """Errors of the velocities in `got` against `want`."""
    return MEASURE.errors_of(cases, got, want)


def rounding_of(cases: Array) -> Array:
    """What the rounding of speeds alone makes of a result, relative to |v1 - v2|."""
    return MEASURE.rounding_of(cases)
