"""The kernel to use for a request: the chosen one, or the default where none was chosen yet."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ..errors import KernelError
from ..registry.presets import find_preset
from ..registry.question import Goal, Question
from ..registry.variant import Stepper, Variant, fixed_steps, make_variant
from ..steppers.exact.budgets import tableaus_for
from ..targets.host import Host
from ..targets.target import Target
from .candidates import default_lanes
from .selection import Selected, Selection, place_of, read_selection


def kernel_for(
    generated: Path, target_name: str, target: Target, scene: str, model: str, goal: Goal
) -> Variant:
    """The chosen kernel for a model and goal, else the options that are safe before any timing.

    Its own number of steps may be another than the goal's.
    """
    for selection in _selections(generated, target_name, target, scene):
        if (entry := selection.find(model, goal)) is not None:
            return entry.variant
    return default_kernel(target, scene, model, goal)


def batch_kernel_for(
    generated: Path, target_name: str, target: Target, scene: str, model: str, goal: Goal
) -> Variant:
    """As kernel_for, with the chosen lanes for its batches, else the widest that the target has.

    Its number of steps is the goal's: a batch function has no other.
    """
    for selection in _selections(generated, target_name, target, scene):
        if (entry := selection.find(model, goal, batch=True)) is not None:
            found = entry.variant
            break
    else:
        found = default_lanes(default_kernel(target, scene, model, goal), target)
    return found if goal.steps is None else found.with_stepper(fixed_steps(goal.steps))


def entries_for(generated: Path, question: Question) -> list[Selected]:
    """The stored choices for a question, that of its own target's folder first."""
    places = (
        place_of(generated, name, question.scene, question.impact)
        for name in (question.target, "native")
    )
    found = [selection for place in places if (selection := read_selection(place)) is not None]
    return [e for s in found for e in s.kernels if e.variant.question == question]


def _selections(
    generated: Path, target_name: str, target: Target, scene: str
) -> Iterator[Selection]:
    """The stored selections of a target, the one that counts first."""
    for name in dict.fromkeys((target_name, target.name)):
        selection = read_selection(place_of(generated, name, scene))
        if selection is not None and selection.resolved == target.name:
            yield selection


def default_kernel(target: Target, scene: str, model: str, goal: Goal) -> Variant:
    """What is used before anything was timed."""
    fma = "fma" if target.has("fma") else "nofma"
    if goal.steps is not None:
        options = {**find_preset("reduced-ahead").options, "fma": fma}
        stepper = fixed_steps(goal.steps)
        return make_variant(target.name, scene, model, stepper, **options)
    stepper = Stepper(tableaus_for(goal.budget or 0.0)[0], budget=goal.budget)
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
