"""The kernel for each target: from a stored selection, else chosen now and stored.

Timing never gives the same figures twice. A folder is therefore made from figures that were
stored: those of a folder of generated/, else those of an earlier choice of our own in the cache.
So the same request gives the same bytes again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..choice.entries import found_errors, selected
from ..choice.folder import checked_selection
from ..choice.job import STEPS, hold, hold_batches
from ..choice.kernel import Rejected
from ..choice.selection import FILE, Selected, Selection, batch_rank, place_of
from ..choice.workbench import Workbench
from ..errors import KernelError
from ..files import write_file
from ..registry.question import Contest, Goal
from ..registry.variant import Variant, fixed_steps
from ..targets.host import Host
from ..targets.target import Target, find_target
from .request import VendorRequest


@dataclass(frozen=True)
class Places:
    """Where selections are stored: the folder `generated`, and ours in the cache."""

    generated: Path
    cache: Path

    def of(self, request: VendorRequest) -> Places:
        """Reproducible kernels are chosen among others, so their choices lie apart."""
        if not request.reproducible:
            return self
        apart = self.cache / "reproducible"
        return Places(apart, apart)

    def folders(self, target: str, scene: str, impact: str) -> tuple[Path, ...]:
        """Where a selection may lie, the one that counts first."""
        roots = (self.generated, self.cache)
        return tuple(place_of(r, name, scene, impact) for r in roots for name in (target, "native"))


@dataclass(frozen=True)
class TargetKernels:
    """What was chosen for one target: for single calls, and for batches where that is another."""

    single: Selected
    batch: Selected | None = None


Chosen = Mapping[str, Mapping[str, TargetKernels]]  # by impact, then by target


def stored_kernels(places: Places, request: VendorRequest, target: str) -> TargetKernels | None:
    """The stored choices for a target and the request's goal, or None."""
    found = _find(places, request, target, request.goal)
    single = next((entry for entry in found if entry.width == 1), None)
    if single is None:
        return None
    wide = [entry for entry in found if entry.width > 1]
    return TargetKernels(single, min(wide, key=batch_rank, default=None))


def _find(places: Places, request: VendorRequest, target: str, goal: Goal) -> list[Selected]:
    """The entries for a goal in the first folder that has any for single calls."""
    for folder in places.of(request).folders(target, request.scene, request.impact):
        selection = checked_selection(folder)
        if selection is None or selection.resolved != target:
            continue
        found = [
            entry
            for entry in selection.kernels
            if (entry.model, entry.goal) == (request.model, goal)
        ]
        if any(entry.width == 1 for entry in found):
            return found
    return []


def kernels_for(
    places: Places,
    request: VendorRequest,
    target: str,
    bench: Workbench,
    host: Host,
    seconds: float,
) -> TargetKernels:
    """The stored choices, else one made by the main job's rules and stored.

    Raises KernelError where no candidate passes verification.
    """
    stored = stored_kernels(places, request, target)
    if stored is not None:
        return stored
    row = find_target(target)
    made = (_chosen if request.goal.steps is None else _with_steps)(
        places, request, row, bench, host, seconds
    )
    _store(places, request, target, made)
    return made


def _chosen(
    places: Places,
    request: VendorRequest,
    target: Target,
    bench: Workbench,
    host: Host,
    seconds: float,
) -> TargetKernels:
    """By the main job's rules, fixed steps at N = 1000: for single calls, then for batches."""
    goal = Goal(steps=STEPS) if request.goal.budget is None else request.goal
    held = (request.impact, target.name, request.scene, request.model)
    contest = Contest(*held, goal, "scalar")
    singles = hold(bench, contest, host, seconds)
    lanes = hold_batches(bench, singles, host, seconds)
    batch = None if lanes is None else selected(lanes.choice)
    return TargetKernels(selected(singles.choice), batch)


def _with_steps(
    places: Places,
    request: VendorRequest,
    target: Target,
    bench: Workbench,
    host: Host,
    seconds: float,
) -> TargetKernels:
    """The loop that is best at N = 1000 is best at any N; only its error is another."""
    thousand = replace(request, goal=Goal(steps=STEPS))
    base = stored_kernels(places, thousand, target.name)
    if base is None:
        base = _chosen(places, request, target, bench, host, seconds)
        _store(places, request, target.name, base)
    if request.goal == thousand.goal:
        return base
    batch = base.batch and _stepped(base.batch, request, target, bench, host)
    return TargetKernels(_stepped(base.single, request, target, bench, host), batch)


def _stepped(
    entry: Selected, request: VendorRequest, target: Target, bench: Workbench, host: Host
) -> Selected:
    """The entry with the request's number of steps, and the error that it has then."""
    steps = request.goal.steps
    variant = entry.variant.with_stepper(fixed_steps(steps))
    update: dict[str, Any] = {
        "question": str(variant.question),
        "ties": [],
        **_errors_of(variant, request, target, bench, host),
    }
    return Selected(**{**entry.model_dump(), **update})


def _errors_of(
    variant: Variant, request: VendorRequest, target: Target, bench: Workbench, host: Host
) -> dict[str, float | None]:
    """The largest errors that verification finds; None where the kernel cannot run here."""
    if not host.runs(target) and bench.emulated is None:
        return {"max_rel_error": None, "worst_estimate_error": None}
    made = bench.check(bench.emit(variant, target))
    if isinstance(made, Rejected):
        raise KernelError(f"{made.name}: {made.text}")
    return found_errors(made.verdict)


def _store(places: Places, request: VendorRequest, target: str, made: TargetKernels) -> None:
    folder = place_of(places.of(request).cache, target, request.scene, request.impact)
    selection = checked_selection(folder) or Selection(
        impact=request.impact, target=target, resolved=target, scene=request.scene, kernels=[]
    )
    entries = [entry for entry in (made.single, made.batch) if entry is not None]
    write_file(folder / FILE, selection.with_entries(entries).text(), parents=True)
