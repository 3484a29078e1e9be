"""How kernels of a ball and a cushion are written: what emission asks of this impact."""

from __future__ import annotations

from ....emission.context import KernelContext, KernelHead, Kernels
from ....errors import InputError
from ....lowering.lanes import LaneContext, lane_context
from ....registry.axes import axis
from .. import words
from ..models import find_model
from ..scene import Scene
from .context import CushionContext
from .exact import exact_method, exact_stepper
from .fixed import fixed_step_method, fixed_step_parts

# Options that these kernels have; all others only at their default.
_OPTIONS = ("fma", "compiler", "flags")


class BallCushionKernels:
    """Kernels by pooltool's fixed steps, and exact ones."""

    def context(self, head: KernelHead) -> KernelContext:
        scene = head.scene
        if not isinstance(scene, Scene):
            raise TypeError(f"{scene.name}: a scene of a ball and a cushion is wanted")
        _require_options(head)
        return _fixed_step(head, scene) if head.fixed_step else _exact(head, scene)


KERNELS: Kernels = BallCushionKernels()


def _require_options(head: KernelHead) -> None:
    """Raise ValueError where an option is asked for that these kernels do not have."""
    for key, code in head.variant.options:
        if key not in _OPTIONS and code != axis(key).default:
            raise ValueError(f"kernels of {head.impact.name} have no {key}={code}; leave it out")


def _fixed_step(head: KernelHead, scene: Scene) -> CushionContext:
    if not scene.fixed_steps:
        raise InputError(f"--scene {scene.name}: {words.NO_FIXED_STEPS}")
    terms = find_model(head.variant.model).terms
    parts = fixed_step_parts(terms, head.places_fma)
    return CushionContext(
        **{**vars(head), "scene": scene},
        body="ball_cushion/fixed.j2",
        one="ball_cushion/collide_one.j2",
        batch=False,
        checks_template="ball_cushion/checks.j2",
        counts=parts.counts,
        method=fixed_step_method(head.steps, parts.counts),
        scheme=parts,
    )


def _lanes(head: KernelHead) -> LaneContext | None:
    """The vocabulary of batches in lanes; None where they go one by one."""
    variant = head.variant
    if variant.width == 1:
        return None
    return lane_context(head.target, variant.width, fma=head.places_fma, estimates=False)


def _exact(head: KernelHead, scene: Scene) -> CushionContext:
    variant = head.variant
    if not find_model(variant.model).terms.sticks:
        raise InputError(f"--max-error: model {variant.model} has fixed steps alone; name --steps")
    budget = variant.stepper.budget or 0.0
    scene.require_budget(budget)
    lanes = _lanes(head)
    stepper = exact_stepper(variant.stepper.name, budget, head.places_fma)
    return CushionContext(
        **{**vars(head), "scene": scene},
        body="ball_cushion/exact.j2",
        one="ball_cushion/collide_one.j2",
        batch=lanes is not None,
        checks_template="ball_cushion/checks.j2",
        counts=stepper.parts.step_counts,
        method=exact_method(stepper),
        shown={"x": stepper, "lanes": lanes},
    )
