"""The kernel to use for a request: the chosen one, or the default where none was chosen yet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from ..errors import KernelError
from ..registry.names import variant_of
from ..registry.presets import find_preset
from ..registry.variant import Stepper, Variant, make_variant
from ..steppers.exact.budgets import tableaus_for
from ..targets.host import Host
from ..targets.target import Target
from .candidates import default_lanes
from .selection import Selection, read_selection


@dataclass(frozen=True)
class Goal:
    """Fixed steps or an error budget: one of them."""

    steps: int | None = None
    budget: float | None = None


def kernel_for(
    generated: Path, target_name: str, target: Target, scene: str, model: str, goal: Goal
) -> Variant:
    """The chosen kernel for a model and goal, else the options that are safe before any timing.

    Its own number of steps may be another than the goal's.
    """
    for selection in _selections(generated, target_name, target, scene):
        entry = selection.find(model, steps=goal.steps, budget=goal.budget)
        if entry is not None:
            return variant_of(entry.kernel)
    return default_kernel(target, scene, model, goal)


def batch_kernel_for(
    generated: Path, target_name: str, target: Target, scene: str, model: str, goal: Goal
) -> Variant:
    """As kernel_for, with the chosen lanes for its batches, else the widest that the target has.

    Its number of steps is the goal's: a batch function has no other.
    """
    for selection in _selections(generated, target_name, target, scene):
        entry = selection.find_batch(model, steps=goal.steps, budget=goal.budget)
        if entry is not None:
            found = variant_of(entry.kernel)
            break
    else:
        found = default_lanes(default_kernel(target, scene, model, goal), target)
    return found if goal.steps is None else replace(found, stepper=Stepper("euler", goal.steps))


def _selections(
    generated: Path, target_name: str, target: Target, scene: str
) -> Iterator[Selection]:
    """The stored selections of a target, the one that counts first."""
    for name in dict.fromkeys((target_name, target.name)):
        selection = read_selection(generated / name / scene)
        if selection is not None and selection.resolved == target.name:
            yield selection


def default_kernel(target: Target, scene: str, model: str, goal: Goal) -> Variant:
    """What is used before anything was timed."""
    fma = "fma" if target.has("fma") else "nofma"
    if goal.steps is not None:
        options = {**find_preset("reduced-ahead").options, "fma": fma}
        stepper = Stepper("euler", steps=goal.steps)
        return make_variant(target.name, scene, model, stepper, **options)
    assert goal.budget is not None
    stepper = Stepper(tableaus_for(goal.budget)[0], budget=goal.budget)
    return make_variant(target.name, scene, model, stepper, fma=fma, root="inv")


def with_compiler_found(variant: Variant, compilers: dict[str, object]) -> Variant:
    """The same kernel by another compiler where its own is not here."""
    if variant["compiler"] in compilers:
        return variant
    return variant.with_options(compiler=next(iter(compilers)))


def require_runs(host: Host, target: Target) -> None:
    """Raise KernelError where a target's code cannot run on this machine."""
    if not host.runs(target):
        lacks = ", ".join(sorted(target.features - host.features)) or target.row.arch
        raise KernelError(f"{target.name} code cannot run here: this CPU lacks {lacks}")
