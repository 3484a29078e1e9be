"""Collisions of billiard balls with friction between them and with the table.

    import carom
    import numpy as np

    kernel = carom.Kernel("mathavan2014", max_error=1e-6)
    cue = np.array([[0, 0, 0.028575], [0, 1.5, 0], [-52.5, 0, 0]])  # position, velocity, spin
    object_ball = np.array([[0.02, 0.0535, 0.028575], [0, 0, 0], [0, 0, 0]], dtype=float)
    cue, object_ball, status = kernel.collide(carom.Parameters(u_b=0.05), cue, object_ball)

SI units, z up. `carom.pooltool` has a collision model for pooltool.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np

from carom._carom import Kernel, Parameters

__all__ = ["Kernel", "Parameters", "Status", "columns"]


class Status(IntEnum):
    """What became of a collision; anything but OK leaves velocities as they came."""

    OK = 0
    SEPARATING = 1  # the balls do not approach each other
    BAD_INPUT = 2  # not finite, coincident centres, or a parameter out of range
    TILTED = 3  # the line of centres rises by more than 1e-6 of its length


def columns(ball1: np.ndarray, ball2: np.ndarray) -> np.ndarray:
    """What `Kernel.collide_batch` takes, from two arrays (n, 3, 3) of balls: an array (18, n)."""
    both = [np.asarray(ball, dtype=np.float64).reshape(-1, 9).T for ball in (ball1, ball2)]
    return np.vstack(both)
