"""What the contract above a kernel of two balls says of its stepper."""

from __future__ import annotations

from ....lowering.counts import OperationCounts
from ....registry.variant import Variant
from ....steppers.exact.context import ExactContext
from .context import BallBallContext


def fixed_step_method(variant: Variant, counts: OperationCounts) -> tuple[str, ...]:
    return (
        f"Stepper: Euler, N = {variant.stepper.steps} steps; error against the vanishing step "
        "about 1/N of the relative speed, up to 1e-3 of it in hard cases at N = 1000.",
        f"Operations an iteration: {counts.describe()} ({counts.flops} flops).",
    )


def exact_method(context: BallBallContext, exact: ExactContext) -> tuple[str, ...]:
    if context.scene.level:
        counts = context.counts
        return (
            "Closed form, exact but for rounding: no ball is pressed onto the table.",
            f"Operations: {counts.describe()} ({counts.flops} flops).",
        )
    table = "" if context.scene.table_friction else " of the contact slip alone"
    return (
        f"Stepper: adaptive {exact.tableau.name}, order {exact.tableau.order}{table}; error "
        f"against the exact solution at most {exact.budget:g} of the relative speed |v1 - v2|, "
        "each of v and R w, as far as verification has seen (docs/accuracy.md).",
        *_batch_lines(context),
        f"Operations a step: {exact.counts.describe()} ({exact.counts.flops} flops), without the "
        "control of its length and the roots' own.",
    )


def _batch_lines(context: BallBallContext) -> tuple[str, ...]:
    """What batches do otherwise than single calls, for the contract."""
    if context.lanes is None or not context.lanes.floats or context.scene.precision == "float":
        return ()
    return (
        "Batches: the steps in floats, whose rounding that bound includes; all that is before and "
        "after them in doubles.",
    )
