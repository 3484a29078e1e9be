"""The impacts that there are: one row each. Adding one is docs/adding-an-impact.md."""

from __future__ import annotations

from ..errors import named
from . import DEFAULT as DEFAULT
from .ball_ball.row import BALL_BALL
from .ball_cushion.row import BALL_CUSHION
from .impact import Impact

IMPACTS: tuple[Impact, ...] = (BALL_BALL, BALL_CUSHION)


def find_impact(name: str) -> Impact:
    """An impact by its name. Raises InputError naming the impacts there are."""
    return named("impact", name, {impact.name: impact for impact in IMPACTS})
