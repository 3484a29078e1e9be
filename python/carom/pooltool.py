"""Collision models for pooltool, in place of its `FrictionalMathavan` and `Mathavan2010`.

    from carom.pooltool import FrictionalMathavan, Mathavan2010Circular, Mathavan2010Linear

    engine = pooltool.physics.PhysicsEngine()  # after 0.6.0: pooltool.evolution.SimulationEngine()
    engine.resolver.ball_ball = FrictionalMathavan()
    exact = {"contact_model": "clamped", "max_error": 1e-6}
    engine.resolver.ball_linear_cushion = Mathavan2010Linear(**exact)
    engine.resolver.ball_circular_cushion = Mathavan2010Circular(**exact)

Needs pooltool 0.5 or 0.6 (PyPI: pooltool-billiards), or its development head, as of June 2026.
"""

from __future__ import annotations

from functools import cache
from importlib.metadata import PackageNotFoundError, version
from math import isclose, isfinite
from typing import Any

from carom import CushionKernel, CushionParameters, Kernel, Parameters, Status

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
    from pooltool.physics.resolve.ball_cushion.core import (
        CoreBallCCushionCollision,
        CoreBallLCushionCollision,
    )
    from pooltool.physics.resolve.models import (
        BallBallModel,
        BallCCushionModel,
        BallLCushionModel,
    )
except ImportError as error:
    raise _unfit(f" ({error})") from error
try:
    from pooltool.physics.dimensionality import Dim
except ModuleNotFoundError:  # up to 0.6.0
    Dim = None


__all__ = ["FrictionalMathavan", "Mathavan2010Circular", "Mathavan2010Linear"]

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


# ---- The cushion -------------------------------------------------------------------------------

_DELTA_P = (1e-9, 1.0)  # N s
_MANY_STEPS = 5000  # from so many on, the kernel's own shortest step is pooltool's shorter one
_NO_IMPACT = "no collision: the ball's state or the cushion's normal is not finite"


@cache
def _cushion_kernel(contact_model: str, max_error: float | None, steps: int) -> CushionKernel:
    if max_error is None:
        return CushionKernel(contact_model, steps=steps)
    return CushionKernel(contact_model, max_error=max_error)


def _impact_can_be_made(model: Any, field: Any, value: Any) -> None:
    """A validator: as `_can_be_made`, of the fields of a cushion's model."""
    asked = {name: getattr(model, name) for name in ("contact_model", "max_error", "max_steps")}
    asked["steps"] = asked.pop("max_steps")
    _cushion_kernel(**{**asked, "steps" if field.name == "max_steps" else field.name: value})


def _is_a_step(_model: Any, _field: Any, value: Any) -> None:
    low, high = _DELTA_P
    if not low <= value <= high:
        raise ValueError(f"delta_p = {value}: expected {low:g} to {high:g} N s")


def _normal(cushion: Any, ball: Ball) -> Any:
    """Level, into the cushion as pooltool takes it: as the ball moves."""
    own = getattr(cushion, "get_normal_xy", None)  # from 0.6.0 on
    normal = own(ball.xyz) if own else cushion.get_normal(ball.state.rvw)
    return normal[:2] if normal @ ball.state.rvw[1] > 0 else -normal[:2]


def _mass(mass: float, model: Any) -> float:
    """The mass at which the kernel's own shortest step does what `delta_p` does.

    Only delta_p / M counts, besides what does not depend on the mass.
    """
    own = 1e-4 if model.max_steps >= _MANY_STEPS else 1e-3
    return mass if model.delta_p == own else mass * (own / float(model.delta_p))


def _solve_cushion(model: Any, ball: Ball, cushion: Any) -> tuple[Ball, Any]:
    """The ball with its velocities after the impact, sliding."""
    params, rvw = ball.params, ball.state.rvw
    exact = model.max_error is not None
    mass = params.m if exact else _mass(params.m, model)
    given = CushionParameters(
        params.R, mass, params.u_s, params.f_c, params.e_c, float(cushion.height)
    )
    kernel = _cushion_kernel(model.contact_model, model.max_error, model.max_steps)
    after, status = kernel.collide(given, rvw[1:], _normal(cushion, ball))
    if status > Status.SEPARATING:
        raise ValueError(_NO_IMPACT)
    state = rvw.copy()
    state[1:] = after
    ball.state = BallState(state, const.sliding)
    return ball, cushion


_TEXT = """pooltool's fields, and two more: which contact model, and an error budget.

    As it stands it gives what pooltool's own class gives. `contact_model` is `pooltool`, `printed`
    or `clamped` (docs/models.md of carom says how they differ). With `max_error` (relative to the
    ball's speed) the exact solution of `printed` or `clamped` is approached that closely, and
    `max_steps` and `delta_p` do not count; the model `pooltool` has fixed steps alone.

    A model, number of steps, `delta_p` or budget that no kernel has is refused when the object is
    made. As in pooltool, a ball that leaves is taken to come.

    `solve` raises ValueError where the ball's state is not finite or a parameter is out of range:
    the nose is from R to below 2 R above the table, and what pooltool computes below R is no impact
    of this model.
    """


@attrs.define
class Mathavan2010Linear(CoreBallLCushionCollision):
    __doc__ = _TEXT

    max_steps: int = attrs.field(default=1000, validator=_impact_can_be_made)
    delta_p: float = attrs.field(default=0.001, validator=_is_a_step)
    contact_model: str = attrs.field(default="pooltool", validator=_impact_can_be_made)
    max_error: float | None = attrs.field(default=None, validator=_impact_can_be_made)

    model: BallLCushionModel = attrs.field(
        default=BallLCushionModel.MATHAVAN_2010, init=False, repr=False
    )
    if Dim is not None:
        dim: Any = attrs.field(default=Dim.TWO, init=False, repr=False)

    def solve(self, ball: Ball, cushion: Any) -> tuple[Ball, Any]:
        """The ball with its velocities after the impact, sliding."""
        return _solve_cushion(self, ball, cushion)


@attrs.define
class Mathavan2010Circular(CoreBallCCushionCollision):
    __doc__ = _TEXT

    max_steps: int = attrs.field(default=1000, validator=_impact_can_be_made)
    delta_p: float = attrs.field(default=0.001, validator=_is_a_step)
    contact_model: str = attrs.field(default="pooltool", validator=_impact_can_be_made)
    max_error: float | None = attrs.field(default=None, validator=_impact_can_be_made)

    model: BallCCushionModel = attrs.field(
        default=BallCCushionModel.MATHAVAN_2010, init=False, repr=False
    )
    if Dim is not None:
        dim: Any = attrs.field(default=Dim.TWO, init=False, repr=False)

    def solve(self, ball: Ball, cushion: Any) -> tuple[Ball, Any]:
        """The ball with its velocities after the impact, sliding."""
        return _solve_cushion(self, ball, cushion)
