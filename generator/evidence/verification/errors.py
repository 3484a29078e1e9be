"""The measure of error that is used everywhere.

Rows of cases have 24 columns (R, M, u_s1, u_s2, u_b, e_b, then position, velocity and angular
velocity of ball 1 and of ball 2), rows of outcomes 12 velocities (v1, w1, v2, w2), then the status,
then, where something is expected, whether the contact sticks. SI units.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import KernelError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

CASE_COLUMNS = 24
OUTCOME_COLUMNS = 13
EXPECTED_COLUMNS = 14
VELOCITIES = 12
STATUS, STICKS = 12, 13
SLIPS, STICKS_YES, NO_END = 0.0, 1.0, 2.0  # values of column STICKS; NO_END: the scheme did not end
_POSITION = (slice(6, 9), slice(15, 18))
_VELOCITY = (slice(9, 12), slice(18, 21))
_SPIN_COLUMNS = (3, 4, 5, 9, 10, 11)


class Errors(NamedTuple):
    """Errors of each case. A NaN or infinity that is not expected counts as infinite."""

    absolute: Array  # m/s: the largest of |dv| and R |dw| over all components
    relative: Array  # absolute, divided by |v1 - v2| before the collision


def check_shapes(cases: Array, **tables: tuple[Array, int]) -> None:
    """Raises KernelError where a table has not one row a case and at least the columns needed."""
    wanted = {"cases": (cases, CASE_COLUMNS), **tables}
    for name, (table, columns) in wanted.items():
        if table.ndim != 2 or table.shape[0] != len(cases) or table.shape[1] < columns:
            raise KernelError(
                f"{name}: {table.shape} values; expected {len(cases)} rows of {columns}"
            )


def component_errors(got: Array, want: Array) -> Array:
    """|got - want|; 0 where both are the same infinity or both NaN, infinite where only one is."""
    with np.errstate(invalid="ignore", over="ignore"):
        difference = np.abs(got - want)
    same = (got == want) | (np.isnan(got) & np.isnan(want))
    difference = np.where(np.isnan(difference), np.inf, difference)
    return np.where(same, 0.0, difference)


def relative_speed(cases: Array) -> Array:
    """|v1 - v2| before the collision, m/s."""
    one, two = _VELOCITY
    with np.errstate(invalid="ignore", over="ignore"):
        speed: Array = np.linalg.norm(cases[:, one] - cases[:, two], axis=1)
        return speed


def approach_speed(cases: Array) -> Array:
    """|v_n| before the collision: speed along the level line of centres, m/s; 0 if undefined."""
    d = cases[:, _POSITION[1]] - cases[:, _POSITION[0]]
    dv = cases[:, _VELOCITY[1]] - cases[:, _VELOCITY[0]]
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        normal = np.abs((d * dv)[:, :2].sum(axis=1)) / np.hypot(d[:, 0], d[:, 1])
    return np.where(np.isfinite(normal), normal, 0.0)


def errors_of(cases: Array, got: Array, want: Array) -> Errors:
    """Errors of the velocities in `got` against `want`."""
    difference = component_errors(got[:, :VELOCITIES], want[:, :VELOCITIES])
    difference[:, _SPIN_COLUMNS] *= np.where(np.isfinite(cases[:, :1]), np.abs(cases[:, :1]), 1.0)
    absolute = np.where(np.isnan(difference), np.inf, difference).max(axis=1)
    speed = relative_speed(cases)
    with np.errstate(invalid="ignore", divide="ignore"):
        relative = np.where(absolute == 0, 0.0, absolute / speed)
    return Errors(absolute, np.where(np.isnan(relative), np.inf, relative))
