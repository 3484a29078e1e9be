"""A collision model for pooltool that takes the place of its `FrictionalMathavan`.

    from carom.pooltool import FrictionalMathavan

    engine = pooltool.physics.PhysicsEngine()  # after 0.6.0: pooltool.evolution.SimulationEngine()
    engine.resolver.ball_ball = FrictionalMathavan()

Needs pooltool 0.5 or 0.6 (PyPI: pooltool-billiards), or its development head, as of June 2026.
"""

from __future__ import annotations

from functools import cache
from importlib.metadata import PackageNotFoundError, version
from math import isclose, isfinite
from typing import Any

from carom import Kernel, Parameters, Status

_FIRST, _LAST = (0, 5), (0, 6)  # releases that the tests run with


def _there() -> str:
    try:
        return version("pooltool-billiards")
    except PackageNotFoundError:
        return "none"


def _unfit(why: str) -> ImportError:
    return ImportError(
        f"carom.pooltool: expected pooltool-billiards from 0.5.0 to 0.6.x; there is {_there()}{why}"
    )


def _is_fit(release: str) -> bool:
    return _FIRST <= tuple(int(part) for part in release.split(".")[:2]) <= _LAST


if _there() != "none" and not _is_fit(_there()):
    raise _unfit("")
try:
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
except ImportError as error:
    raise _unfit(f" ({error})") from error
try:
    from pooltool.physics.dimensionality import Dim
except ModuleNotFoundError:  # up to 0.6.0
    Dim = None


__all__ = ["FrictionalMathavan"]

_SAME = 1e-9  # masses or radii that differ by less are equal but for rounding
_MOST_RATIO = 10.0  # of masses, as the kernels of two masses take them
_AS_POOLTOOL = "contact_model='pooltool' takes both balls to be as the first, as pooltool does"
_NOT_FINITE = "no collision: a ball's state is not finite, or both centres are one"
_TILTED = (
    "the balls' centres are not level; contact_model='pooltool' accepts that, other models do not"
)
_UNEQUAL_ERROR = 1e-6  # where no budget is asked for: the fixed-step scheme is of equal balls


@cache
def _kernel(contact_model: str, max_error: float | None, steps: int) -> Kernel:
    if max_error is None:
        return Kernel(contact_model, steps=steps)
    return Kernel(contact_model, max_error=max_error)


def _can_be_made(model: Any, field: Any, value: Any) -> None:
    """A validator: raises where no kernel has the three fields, when made and when one is set."""
    asked = {name: getattr(model, name) for name in ("contact_model", "max_error")}
    asked = {**asked, "steps": model.num_iterations}
    _kernel(**{**asked, "steps" if field.name == "num_iterations" else field.name: value})


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

    A model, number of steps or budget that no kernel has is refused when the object is made.

    `solve` raises ValueError where a ball's state is not finite, the centres coincide or a
    parameter is out of range, and for any model but `pooltool` where the line of centres is not
    level. Balls that do not approach each other keep their velocities.
    """

    friction: BallBallFrictionStrategy = attrs.field(factory=AlciatoreBallBallFriction)
    num_iterations: int = attrs.field(default=1000, validator=_can_be_made)
    contact_model: str = attrs.field(default="pooltool", validator=_can_be_made)
    max_error: float | None = attrs.field(default=None, validator=_can_be_made)

    model: BallBallModel = attrs.field(
        default=BallBallModel.FRICTIONAL_MATHAVAN, init=False, repr=False
    )
    if Dim is not None:  # what its engine asks of a strategy
        dim: Any = attrs.field(default=Dim.TWO, init=False, repr=False)

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
        if not isfinite(friction):  # it is of the balls' velocities
            raise ValueError(_NOT_FINITE)
        given = Parameters(one.R, mass2, one.u_s, two.u_s, friction, restitution, M1=one.m)
        kernel = _kernel(self.contact_model, max_error, self.num_iterations)
        after1, after2, status = kernel.collide(given, before1, before2)
        if status > Status.SEPARATING:
            raise ValueError(_TILTED if status == Status.TILTED else _NOT_FINITE)
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
