"""What a search aims at is where the kernels of two balls change their method."""

from __future__ import annotations

from generator.impacts.ball_ball.search.charts import THRESHOLDS
from generator.impacts.ball_ball.steppers.exact.context import ExactContext
from generator.impacts.ball_ball.steppers.tiers.bounds import Bound, Sticks


def test_charts_aim_at_the_restitutions_where_the_method_changes() -> None:
    little = ExactContext.__dataclass_fields__["little_bounce"].default
    print(f"aims: {THRESHOLDS}")
    assert (little, Bound.least_e_b) == THRESHOLDS
    assert Sticks.least_e_b == Bound.least_e_b
