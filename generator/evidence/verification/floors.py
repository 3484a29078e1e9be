"""What no kernel in double can be surely nearer than: the rounding of what it is given."""

from __future__ import annotations

import numpy as np

from .errors import Array

UNIT = 2.0**-52
_SPEEDS, _SPINS = [*range(9, 12), *range(18, 21)], [*range(12, 15), *range(21, 24)]


def rounding_of(cases: Array) -> Array:
    """What the rounding of speeds alone makes of a result, relative to |v1 - v2|.

    Four units in the last place of the fastest speed of a case (of v or R w): where balls are much
    faster than they approach, no kernel whose input and output are doubles can be surely nearer.
    The exact result itself moves by as much when a speed changes by its last bit.
    """
    speeds = np.abs(cases[:, _SPEEDS])
    spins = np.abs(cases[:, _SPINS]) * cases[:, :1]
    fastest = np.maximum(speeds.max(axis=1), spins.max(axis=1))
    approach = np.linalg.norm(cases[:, 9:12] - cases[:, 18:21], axis=1)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return np.where(approach > 0, 4 * UNIT * fastest / approach, np.inf)


def nudged(case: Array, count: int, columns: tuple[int, ...]) -> Array:
    """The case, then `count` - 1 like it whose numbers in `columns` changed by a last bit."""
    cases = np.tile(case, (count, 1))
    shape = (count - 1, len(columns))
    signs = np.random.default_rng(1).choice([-1.0, 0.0, 1.0], shape)
    cases[1:, columns] *= 1 + signs * UNIT
    return cases


SPEEDS = (*range(9, 15), *range(18, 24))
