"""What a stepper gives to the text of a kernel of two balls."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ....errors import InputError
from ....lowering.counts import OperationCounts
from ....lowering.lanes import LaneContext, lane_context
from ....registry.lane_numbers import precision_of
from ....registry.variant import Variant
from ....targets.target import Target
from ..scene import find_scene


@dataclass(frozen=True)
class KernelParts:
    """Templates, what they see, and what the contract says of the method."""

    core_template: str
    batch_template: str  # of kernels with lanes
    counts: OperationCounts  # of an iteration, a step, or the closed form
    contract: tuple[str, ...]  # the method in a line, then what else is to be said
    shown: Mapping[str, object]  # names that the stepper's templates know
    lanes: LaneContext | None  # the vocabulary of batches in lanes
    vector_frame: bool = False  # is a collision's way in and out made in vectors?


def lanes_of(variant: Variant, target: Target) -> LaneContext | None:
    """The vocabulary of a variant's batches; None where they go one by one."""
    if variant.width == 1:
        return None
    return lane_context(
        target,
        variant.width,
        variant.vectors,
        variant["fma"] == "fma",
        precision_of(variant),
        variant["lane_root"] != "ieee",
    )


def refuse_lanes(variant: Variant) -> None:
    """InputError where a scene has no exact lanes and the variant wants some."""
    scene = find_scene(variant.scene)
    if variant.width > 1 and (reason := scene.without_exact_lanes):
        raise InputError(f"--scene {scene.name}: {reason}; expected width 1")
