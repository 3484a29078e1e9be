"""The columns of two balls: cases in rows of 24, outcomes in rows of 12 velocities and more."""

from __future__ import annotations

from ..columns import Columns
from .parameters import NAMES

_BALL = tuple(f"{quantity}{{}}{axis}" for quantity in "rvw" for axis in "xyz")
_MOVES = _BALL[3:]  # of them, what a collision changes
COLUMNS = Columns(
    parameters=NAMES,
    motion=tuple(name.format(ball) for ball in "12" for name in _BALL),
    velocities=tuple(name.format(ball) for ball in "12" for name in _MOVES),
)


def _vector(names: tuple[str, ...], first: str) -> slice:
    start = names.index(first)
    return slice(start, start + 3)


# Of a case: position, velocity and angular velocity of either ball.
R1, V1, W1, R2, V2, W2 = (
    _vector(COLUMNS.case, f"{quantity}{ball}x") for ball in "12" for quantity in "rvw"
)
BALLS = slice(R1.start, W1.stop), slice(R2.start, W2.stop)
# Of an outcome.
V1_AFTER, W1_AFTER, V2_AFTER, W2_AFTER = (
    _vector(COLUMNS.velocities, f"{quantity}{ball}x") for ball in "12" for quantity in "vw"
)
SPINS_AFTER = [n for n, name in enumerate(COLUMNS.velocities) if name.startswith("w")]
