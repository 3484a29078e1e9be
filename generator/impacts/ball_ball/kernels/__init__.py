"""How kernels of two balls are written: what emission asks of this impact."""

from __future__ import annotations

from dataclasses import replace

from ....emission.context import KernelContext, KernelHead, Kernels
from ....errors import InputError
from ....lowering import isa
from ....lowering.collision_ends import CollisionEnds, at_zero
from ....lowering.counts import OperationCounts
from ....lowering.lanes import LaneContext, lane_context
from ....registry.lane_numbers import precision_of
from ....registry.variant import Variant
from ....steppers.exact.context import exact_context
from ....steppers.fixed.batch import fixed_step_batch
from ....steppers.fixed.loops import LoopBuilder
from .. import words
from ..masses import masses_of
from ..models import find_model
from ..scene import Scene
from ..terms import ContactTerms
from .context import BallBallContext
from .contract import exact_method, fixed_step_method


class BallBallKernels:
    """Kernels by fixed steps, by exact ones and, of level motions, by a closed form."""

    def context(self, head: KernelHead) -> KernelContext:
        scene, terms = head.scene, find_model(head.variant.model).terms
        if not isinstance(scene, Scene):
            raise TypeError(f"{scene.name}: a scene of two balls is wanted")
        start = _at_start(head, scene, terms)
        return _fixed_step(start, terms) if head.fixed_step else _exact(start, terms)


KERNELS: Kernels = BallBallKernels()


def _at_start(head: KernelHead, scene: Scene, terms: ContactTerms) -> BallBallContext:
    """What kernels of all steppers have."""
    vector_frame = head.variant.get("simd") == "prepost"
    frame = "vector" if vector_frame else "scalar"
    motions, level_pairs = words.motions(scene)
    law = words.law(scene)
    place_fma = head.variant["fma"] == "fma"
    slips = [_contact_slip(scene, terms, place_fma, wide) for wide in (False, True)] if law else []
    return BallBallContext(
        **{**vars(head), "scene": scene},
        body="ball_ball/body.j2",
        one="ball_ball/collide_one.j2",
        batch=head.variant.width > 1,
        keep="copy_balls",
        method=(),
        counts=OperationCounts(),
        derived_members=_BETAS if scene.masses_given else (),
        derived_values=_BETA_VALUES if scene.masses_given else (),
        tilt_allowed=head.variant.model == "pooltool",
        vector_frame=vector_frame,
        core_template="fixed_step/core.j2",
        project_template=f"sections/project_{frame}.j2",
        restore_template=f"sections/restore_{frame}.j2",
        lift=terms.lift,
        motions=motions,
        level_pairs=level_pairs if scene.level and terms.lift else (),
        law=law,
        contact_slip=slips[0] if slips else (),
        lanes_slip=slips[1] if slips else (),
    )


_BETAS = (
    "double beta1, beta2;  // inverse masses, over half of what the two inverses are together",
)
_BETA_VALUES = (
    "p.beta1 = 2.0 * (p.M / (p.M1 + p.M));",
    "p.beta2 = 2.0 * (p.M1 / (p.M1 + p.M));",
)


def _contact_slip(
    scene: Scene, terms: ContactTerms, place_fma: bool, lanes: bool
) -> tuple[str, ...]:
    ends = CollisionEnds(terms, masses_of(scene.mass_ratio), at_zero(scene), place_fma, lanes)
    return ends.slips(("c_x", "c_z")).lines


def _exact(context: BallBallContext, terms: ContactTerms) -> BallBallContext:
    """What the exact core needs; the operations of a step, or of the closed form."""
    variant, scene = context.variant, context.scene
    scene.require_budget(variant.stepper.budget or 0.0)
    exact = exact_context(variant, scene, terms, context.target)
    lanes = _lanes(context) if variant.width > 1 else None
    core, counts = "exact/single.j2", exact.counts
    if not scene.table_friction:
        core = "exact/free.j2"
    if scene.level:
        core = "exact/level_only.j2"
        # The closed form's own: the normal impulse, the least of two, its sign.
        own = OperationCounts(add=1, mul=4, compare=1, select=1)
        counts = exact.level.after.counts + own
    filled = replace(context, exact=exact, lanes=lanes, core_template=core, counts=counts)
    shown = {"x": exact, "lanes": lanes, "b": None}
    return replace(filled, shown=shown, method=exact_method(filled, exact))


def _lanes(context: BallBallContext) -> LaneContext:
    """The vocabulary of a variant's batches. InputError where its scene has none."""
    variant, scene = context.variant, context.scene
    if not context.fixed_step and (reason := scene.without_exact_lanes):
        raise InputError(f"--scene {scene.name}: {reason}; expected width 1")
    estimates = variant["lane_root"] != "ieee"
    return lane_context(
        context.target,
        variant.width,
        variant.vectors,
        context.places_fma,
        precision_of(variant),
        estimates,
    )


def _fixed_step(context: BallBallContext, terms: ContactTerms) -> BallBallContext:
    """What the fixed-step core needs; the operations of an iteration."""
    variant, scene, target = context.variant, context.scene, context.target
    if not scene.fixed_steps:
        raise InputError(f"--scene {scene.name}: {words.NO_FIXED_STEPS}")
    builder = LoopBuilder(variant, terms)
    functions = tuple(builder.loops(scene.level))
    chosen, method = variant["branch"] == "chosen", variant["rsqrt"]
    estimated, paired = method.startswith("est"), variant["simd"] in ("balls", "slips")
    lanes = _lanes(context) if variant.width > 1 else None
    batch = None if lanes is None else fixed_step_batch(variant, terms, lanes)
    counts = next((f for f in functions if f.pressed), functions[0]).counts()
    return replace(
        context,
        functions=functions,
        helpers=() if scene.level and chosen else _helpers(variant),  # no root is taken there
        chosen=chosen,
        c_z_before=tuple(builder.low.slips_of_contact(only=("c_z",))),
        estimate=isa.estimate(target, int(method[-1])) if estimated else None,
        rsqrt_call=f"rsqrt_newton{method[-1]}" if estimated else context.rsqrt_call,
        pair_rsqrt=isa.pair_root(target, method) if paired else (),
        pair_fma=isa.pair_fma(target) if paired and context.places_fma else "",
        lanes=lanes,
        euler_batch=batch,
        counts=counts,
        method=fixed_step_method(variant, counts),
        shown={"x": None, "lanes": lanes, "b": batch},
    )


def _helpers(variant: Variant) -> tuple[str, ...]:
    wanted = []
    rsqrt, simd = variant["rsqrt"], variant["simd"]
    chosen = variant["branch"] == "chosen"
    if rsqrt != "div" or chosen:
        wanted.append("exact_rsqrt")
    if rsqrt in ("est1", "est2"):
        wanted.append("estimate")
    if rsqrt in ("prev", "ahead"):
        wanted.append("refined")
    if variant["branch"] == "bitmask":
        wanted.append("masked")
    if simd in ("balls", "slips"):
        wanted.append("pair")
    if chosen:
        wanted.append("progress")
    return tuple(f"fixed_step/helpers/{name}.j2" for name in wanted)
