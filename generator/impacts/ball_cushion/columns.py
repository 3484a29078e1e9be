"""The columns of a ball and a cushion: cases in rows of 14, outcomes in rows of 6 and more."""

from __future__ import annotations

from ..columns import Columns
from .parameters import NAMES

_BALL = ("vx", "vy", "vz", "wx", "wy", "wz")
NORMAL = ("nx", "ny")  # in the table plane, into the cushion
COLUMNS = Columns(parameters=NAMES, motion=(*_BALL, *NORMAL), velocities=_BALL)
