"""The kernel to use for a request: the chosen one, or the default where none was chosen yet."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ..errors import KernelError
from ..registry.question import Contest, Question
from ..registry.variant import Variant, fixed_steps
from ..targets.host import Host
from ..targets.target import Target, target_or_port
from .candidates import default_kernel, default_lanes
from .selection import Selected, Selection, place_of, read_selection


def kernel_for(generated: Path, target_name: str, contest: Contest) -> Variant:
    """The chosen kernel for a model and goal, else the options that are safe before any timing.

    Its own number of steps may be another than the goal's.
    """
    for selection in _selections(generated, target_name, contest):
        if (entry := selection.find(contest.model, contest.goal)) is not None:
            return entry.variant
    return default_kernel(contest)


def batch_kernel_for(generated: Path, target_name: str, contest: Contest) -> Variant:
    """As kernel_for, with the chosen lanes for its batches, else the widest that the target has.

    Its number of steps is the goal's: a batch function has no other.
    """
    goal = contest.goal
    for selection in _selections(generated, target_name, contest):
        if (entry := selection.find(contest.model, goal, batch=True)) is not None:
            found = entry.variant
            break
    else:
        found = default_lanes(default_kernel(contest), target_or_port(contest.target))
    return found if goal.steps is None else found.with_stepper(fixed_steps(goal.steps))


def entries_for(generated: Path, question: Question) -> list[Selected]:
    """The stored choices for a question, that of its own target's folder first."""
    places = (
        place_of(generated, name, question.scene, question.impact)
        for name in (question.target, "native")
    )
    found = [selection for place in places if (selection := read_selection(place)) is not None]
    return [e for s in found for e in s.kernels if e.variant.question == question]


def _selections(generated: Path, target_name: str, contest: Contest) -> Iterator[Selection]:
    """The stored selections of a target, the one that counts first."""
    for name in dict.fromkeys((target_name, contest.target)):
        selection = read_selection(place_of(generated, name, contest.scene, contest.impact))
        if selection is not None and selection.resolved == contest.target:
            yield selection


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
