"""The impacts that there are: one row each. Adding one is docs/adding-an-impact.md."""

from __future__ import annotations

from ..errors import InputError
from .ball_ball.row import BALL_BALL
from .ball_cushion.row import BALL_CUSHION
from .impact import Impact

IMPACTS: tuple[Impact, ...] = (BALL_BALL, BALL_CUSHION)
DEFAULT = BALL_BALL.name


def find_impact(name: str) -> Impact:
    """An impact by its name. Raises InputError naming the impacts there are."""
    for impact in IMPACTS:
        if impact.name == name:
            return impact
    names = ", ".join(impact.name for impact in IMPACTS)
    raise InputError(f"--impact {name}: no such impact; there are {names}")
