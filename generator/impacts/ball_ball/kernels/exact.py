"""What an exact stepper gives to a kernel of two balls."""

from __future__ import annotations

from dataclasses import replace

from ....lowering.counts import OperationCounts
from ....lowering.lanes import LaneContext
from ....registry.variant import Variant
from ....targets.target import Target
from ..models import ContactModel, find_model
from ..scene import Scene, find_scene
from ..steppers.exact.context import ExactContext
from ..steppers.exact.making import exact_context
from ..steppers.tiers.context import TierContext, tier_context
from .parts import KernelParts, lanes_of, refuse_lanes

# The closed form's own operations: the normal impulse, the least of two, its sign.
_CLOSED = OperationCounts(add=1, mul=4, compare=1, select=1)


def exact_parts(variant: Variant, target: Target) -> KernelParts:
    """Templates and numbers of an exact kernel. InputError where its scene has none."""
    scene = find_scene(variant.scene)
    scene.require_budget(variant.stepper.budget or 0.0)
    model = find_model(variant.model)
    exact = exact_context(variant, scene, model.terms, target)
    refuse_lanes(variant)
    lanes = lanes_of(variant, target)
    counts = exact.level.after.counts + _CLOSED if scene.level else exact.counts
    tiers = _tiers(variant, "lane_tiers")
    if tiers and exact.batch:
        exact = replace(exact, batch=replace(exact.batch, entry="collide_adaptively"))
    return KernelParts(
        core_template=_core(scene),
        batch_template=_batch(scene, tiers),
        counts=counts,
        contract=_closed_contract(counts) if scene.level else _contract(exact, model, scene, lanes),
        shown={
            "x": exact,
            "single": exact,
            "fixed": _tiers(variant, "tiers"),
            **({"t": tiers} if tiers else {}),
        },
        lanes=lanes,
    )


def _core(scene: Scene) -> str:
    if scene.level:
        return "ball_ball/exact/level_only.j2"
    return "ball_ball/exact/single.j2" if scene.table_friction else "ball_ball/exact/free.j2"


def _tiers(variant: Variant, axis: str) -> TierContext | None:
    """The fixed steps in front of the adaptive ones, of calls or in lanes; None: there are none."""
    kind = variant.get(axis, "adaptive")
    if kind == "adaptive":
        return None
    terms, budget = find_model(variant.model).terms, variant.stepper.budget or 0.0
    return tier_context(terms, budget, alone=axis == "tiers", sticking=kind == "sticking")


def _batch(scene: Scene, tiers: TierContext | None) -> str:
    if tiers:
        return "ball_ball/tiers/batch.j2"
    return "ball_ball/exact/level_batch.j2" if scene.level else "ball_ball/exact/batch.j2"


def _closed_contract(counts: OperationCounts) -> tuple[str, ...]:
    return (
        "Closed form, exact but for rounding: no ball is pressed onto the table.",
        f"Operations: {counts.describe()} ({counts.flops} flops).",
    )


def _promised(model: ContactModel, scene: Scene) -> str:
    """Up to which frictions, where the scene leaves them open."""
    keys = (("u_b", "u_b"), *((("u_s1", "u_s"),) if scene.table_friction else ()))
    most = dict(model.most)
    return " and ".join(
        f"{name} to {min(most[name], _highest(scene, key)):g}" for key, name in keys
    )


def _highest(scene: Scene, key: str) -> float:
    return scene.fixed[key] if key in scene.fixed else scene.range_of(key)[1]


def _contract(
    exact: ExactContext, model: ContactModel, scene: Scene, lanes: LaneContext | None
) -> tuple[str, ...]:
    table = "" if scene.table_friction else " of the contact slip alone"
    batches = (
        "Batches: the steps in floats, whose rounding that bound includes; all that is before and "
        "after them in doubles."
    )
    own = lanes is not None and lanes.floats and scene.precision != "float"
    return (
        f"Stepper: adaptive {exact.tableau.name}, order {exact.tableau.order}{table}; each of v "
        f"and R w within {exact.budget:g} of the relative speed |v1 - v2| of the exact solution by "
        f"design, {_promised(model, scene)}; the largest error found by search: docs/accuracy.md.",
        *((batches,) if own else ()),
        f"Operations a step: {exact.counts.describe()} ({exact.counts.flops} flops), without the "
        "control of its length and the roots' own.",
    )
