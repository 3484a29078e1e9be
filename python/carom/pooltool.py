"""A collision model for pooltool that takes the place of its `FrictionalMathavan`.

    from carom.pooltool import FrictionalMathavan

    engine = pooltool.physics.PhysicsEngine()
    engine.resolver.ball_ball = FrictionalMathavan()

Needs pooltool 0.6 (PyPI: pooltool-billiards).
"""

from __future__ import annotations

from functools import cache
from math import isclose

import attrs
import pooltool.constants as const
from pooltool.objects.ball.datatypes import Ball, BallState
from pooltool.objects.ball.params import BallParams
from pooltool.physics.resolve.ball_ball.core import CoreBallBallCollision
from pooltool.physics.resolve.ball_ball.friction import (
    AlciatoreBallBallFriction,
    BallBallFrictionStrategy,
)
from pooltool.physics.resolve.models import BallBallModel

from carom import Kernel, Parameters, Status

__all__ = ["FrictionalMathavan"]

_SAME = 1e-9  # masses or radii that differ by less are equal but for rounding
_MOST_RATIO = 10.0  # of masses, as the kernels of two masses take them
_AS_POOLTOOL = "contact_model='pooltool' takes both balls to be as the first, as pooltool does"
_UNEQUAL_ERROR = 1e-6  # where no budget is asked for: the fixed-step scheme is of equal balls


@cache
def _kernel(contact_model: str, max_error: float | None, steps: int) -> Kernel:
    if max_error is None:
        return Kernel(contact_model, steps=steps)
    return Kernel(contact_model, max_error=max_error)


@attrs.define
class FrictionalMathavan(CoreBallBallCollision):
    """pooltool's fields, and two more: which contact model, and an error budget.

    As it stands it gives what pooltool's own class gives. `contact_model` is `pooltool`,
    `bottom_slip` or `mathavan2014` (docs/models.md of carom says how they differ). With `max_error`
    (relative to the balls' relative speed) the exact solution is approached that closely and
    `num_iterations` does not count. Balls stay on the table: a lifted ball's vertical velocity
    counts during the collision where the model has it, and is dropped after it, as pooltool does.

    The balls' `e_b` are averaged and each has its own `u_s`, as in pooltool; `friction` says what
    `u_b` is. Balls of unequal mass or radius: `contact_model="pooltool"` gives what pooltool gives,
    which takes both to be as `ball1`, so that momentum is not kept. The other models compute what
    either mass does, one to ten times the other; there the exact solution is approached whatever
    `num_iterations` says, to 1e-6 where there is no `max_error`. For radii that differ, and masses
    that differ by more, `solve` raises ValueError that names both values.

    `solve` raises ValueError where a ball's state is not finite, the centres coincide or a
    parameter is out of range, and for any model but `pooltool` where the line of centres is not
    level. Balls that do not approach each other keep their velocities.
    """

    friction: BallBallFrictionStrategy = attrs.field(factory=AlciatoreBallBallFriction)
    num_iterations: int = 1000
    contact_model: str = "pooltool"
    max_error: float | None = None

    model: BallBallModel = attrs.field(
        default=BallBallModel.FRICTIONAL_MATHAVAN, init=False, repr=False
    )

    def solve(self, ball1: Ball, ball2: Ball) -> tuple[Ball, Ball]:
        """The balls with their velocities after the collision, sliding."""
        one, two = ball1.params, ball2.params
        before1, before2 = ball1.state.rvw, ball2.state.rvw
        mass2, max_error = one.m, self.max_error
        if self.contact_model != "pooltool":
            _require_one_radius(one, two)
            if not isclose(one.m, two.m, rel_tol=_SAME):
                _require_ratio(one, two)
                mass2, max_error = two.m, max_error or _UNEQUAL_ERROR
        friction = self.friction.calculate_friction(ball1, ball2)
        restitution = (one.e_b + two.e_b) / 2
        given = Parameters(one.R, mass2, one.u_s, two.u_s, friction, restitution, M1=one.m)
        kernel = _kernel(self.contact_model, max_error, self.num_iterations)
        after1, after2, status = kernel.collide(given, before1, before2)
        if status > Status.SEPARATING:
            _refuse(Status(status), given)
        after1[1, 2], after2[1, 2] = before1[1, 2], before2[1, 2]
        ball1.state = BallState(after1, const.sliding)
        ball2.state = BallState(after2, const.sliding)
        return ball1, ball2


def _require_one_radius(one: BallParams, two: BallParams) -> None:
    if not isclose(one.R, two.R, rel_tol=_SAME):
        raise ValueError(
            f"balls of unequal radius, {one.R:g} and {two.R:g} m: expected the same; {_AS_POOLTOOL}"
        )


def _require_ratio(one: BallParams, two: BallParams) -> None:
    if not max(one.m, two.m) <= _MOST_RATIO * min(one.m, two.m):
        raise ValueError(
            f"balls of mass {one.m:g} and {two.m:g} kg: expected a ratio from {1 / _MOST_RATIO:g} "
            f"to {_MOST_RATIO:g}; {_AS_POOLTOOL}"
        )


def _refuse(status: Status, given: Parameters) -> None:
    if status == Status.TILTED:
        raise ValueError(
            "the balls' centres are not level; contact_model='pooltool' accepts that, other models "
            "do not"
        )
    raise ValueError(f"no collision: a ball's state is not finite, or out of range: {given}")
