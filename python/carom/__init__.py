"""Collisions of billiard balls with friction between them and with the table.

    import carom

    kernel = carom.Kernel("mathavan2014", max_error=1e-6)
    cue = [[0, 0, 0.028575], [0, 1.5, 0], [-52.5, 0, 0]]  # position, velocity, angular velocity
    ball = [[0.02, 0.0535, 0.028575], [0, 0, 0], [0, 0, 0]]
    cue_after, ball_after, status = kernel.collide(carom.Parameters(u_b=0.05), cue, ball)

    cushion = carom.CushionKernel("clamped", max_error=1e-6)
    roll = [[0, 1.0, 0], [-35, 0, 0]]  # velocity, angular velocity; into a cushion along y
    ball_after, status = cushion.collide(carom.CushionParameters(u_w=0.2), roll, [0, 1])

SI units, z up. `carom.pooltool` has models of both for pooltool.
"""

from __future__ import annotations

import numpy as np

from carom import types
from carom._carom import CushionKernel, CushionParameters, Kernel, Parameters, Status
from carom._carom import version as __version__

__all__ = [
    "CushionKernel",
    "CushionParameters",
    "Kernel",
    "Parameters",
    "Status",
    "__version__",
    "columns",
    "types",
]


def columns(ball1: types.Balls, ball2: types.Balls) -> types.Array:
    """What `Kernel.collide_batch` takes, from two arrays (n, 3, 3) of balls: an array (18, n)."""
    both = [np.asarray(ball, dtype=np.float64).reshape(-1, 9).T for ball in (ball1, ball2)]
    return np.vstack(both)
