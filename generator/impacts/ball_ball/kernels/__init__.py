"""How kernels of two balls are written: what emission asks of this impact."""

from __future__ import annotations

from ....emission.context import KernelContext, KernelHead, Kernels
from .. import words
from ..masses import masses_of
from ..models import find_model
from ..scene import Scene
from ..steppers.collision_ends import CollisionEnds, at_zero
from .context import BallBallContext
from .exact import exact_parts
from .fixed import fixed_step_parts

_PARTS = {"fixed": fixed_step_parts, "exact": exact_parts}  # by the family of the stepper


class BallBallKernels:
    """The two ends of a collision are the same for all steppers; the rest is a stepper's parts."""

    def context(self, head: KernelHead) -> KernelContext:
        scene, variant = head.scene, head.variant
        if not isinstance(scene, Scene):
            raise TypeError(f"{scene.name}: a scene of two balls is wanted")
        parts = _PARTS[variant.stepper.family](variant, head.target)
        motions, level_pairs = words.motions(scene)
        return BallBallContext(
            **{**vars(head), "scene": scene},
            body="ball_ball/body.j2",
            one="ball_ball/collide_one.j2",
            batch=parts.lanes is not None,
            keep="copy_balls",
            method=parts.contract,
            counts=parts.counts,
            derived_members=_BETAS if scene.masses_given else (),
            derived_values=_BETA_VALUES if scene.masses_given else (),
            shown={"lanes": parts.lanes, **parts.shown},
            parts=parts,
            tilt_allowed=variant.model == "pooltool",
            contact_slip=_law_slips(head, scene, lanes=False),
            lanes_slip=_law_slips(head, scene, lanes=True),
            law=words.law(scene),
            motions=motions,
            level_pairs=level_pairs if scene.level and find_model(variant.model).terms.lift else (),
        )


KERNELS: Kernels = BallBallKernels()

_BETAS = (
    "double beta1, beta2;  // inverse masses, over half of what the two inverses are together",
)
_BETA_VALUES = (
    "p.beta1 = 2.0 * (p.M / (p.M1 + p.M));",
    "p.beta2 = 2.0 * (p.M1 / (p.M1 + p.M));",
)


def _law_slips(head: KernelHead, scene: Scene, lanes: bool) -> tuple[str, ...]:
    """c_x and c_z before, where friction follows from them."""
    if words.law(scene) is None:
        return ()
    terms, masses = find_model(head.variant.model).terms, masses_of(scene.mass_ratio)
    ends = CollisionEnds(terms, masses, at_zero(scene), head.places_fma, lanes)
    return ends.slips(("c_x", "c_z")).lines
