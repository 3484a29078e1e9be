"""A chosen exact kernel is searched for errors; one that the search finds over is not chosen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import KernelError
from ..evidence.challenge.kept import csv_row
from ..evidence.challenge.place import found_search
from ..evidence.challenge.search import (
    Finding,
    Limits,
    Subject,
    counts_as_over,
    errors_confirmed,
    search,
)
from ..evidence.records.code import key_of
from ..evidence.verification.errors import Array
from ..impacts.impact import Impact
from .choose import Choice
from .kernel import Rejected, Verified
from .workbench import Workbench

# The kernels of a contest, each as far as it came; and how one of them is chosen.
Entries = Sequence[Verified | Rejected]
Choose = Callable[[Entries], tuple[Entries, Choice]]

EVALUATIONS = 20_000  # a second or two of an idle machine's two cores
SEED = 2014
TRIES = 3  # kernels that are searched for one choice


@dataclass(frozen=True)
class Sought:
    """What a short search found of a kernel."""

    evaluations: int
    seed: int
    over: float | None  # largest error over the budget; None: valid input is refused
    held: bool
    case: str  # a row in the columns of reference/inputs.csv

    def told(self) -> str:
        """For the summary and for selection.json."""
        largest = "valid input refused" if self.over is None else f"{self.over:.3g} of the budget"
        verdict = "" if self.held else "OVER: "
        return f"{verdict}{largest}, {self.evaluations} evaluations, seed {self.seed}"


def choose_sought(bench: Workbench, kernels: Entries, choose: Choose) -> tuple[Entries, Choice]:
    """The first choice that holds under the worst root estimates, and a short search.

    What does not is rejected and the next is chosen, which meets the case that the search found
    first. Where the search finds `TRIES` kernels over, or no other is left, the first choice
    stands, and says so: a kernel that nearly always holds is worth more than none.
    """
    first: Choice | None = None
    known: list[Array] = []
    left = kernels
    for _ in range(TRIES):
        try:
            left, choice = _held_at_worst(bench, left, choose)
        except KernelError:
            if first is None:
                raise
            break
        found = sought(bench, choice.chosen, known)
        if found is None:
            return left, choice
        case = "" if found.held else f"; case {found.case}"
        choice = replace(choice, sought=found.told() + case)
        if found.held:
            return left, choice
        first = first or choice
        known.append(np.array(found.case.split(",")[2:], dtype=np.float64))
        left = _with(left, Rejected(choice.chosen, "search", f"search: {found.told()}"))
    if first is None:
        raise KernelError("no kernel was searched")
    return _with(left, first.chosen), first


def _held_at_worst(bench: Workbench, kernels: Entries, choose: Choose) -> tuple[Entries, Choice]:
    """The first choice that holds under the worst root estimates. KernelError where none does."""
    while True:
        kernels, choice = choose(kernels)
        held = bench.verifier.verify_at_worst(choice.chosen)
        kernels = _with(kernels, held)
        if not isinstance(held, Rejected):
            return kernels, replace(choice, chosen=held)


def _with(kernels: Entries, one: Verified | Rejected) -> Entries:
    """A kernel in the place of what it was before."""
    return [one if kernel.name == one.name else kernel for kernel in kernels]


def sought(bench: Workbench, candidate: Verified, known: Sequence[Array]) -> Sought | None:
    """What `known` cases show, else what a short search finds, which is kept.

    None where the kernel has no budget or cannot run here, or nothing searches its impact yet.
    """
    budget = candidate.variant.stepper.budget
    if budget is None or bench.emulated:
        return None
    variant = candidate.variant
    if (space := found_search(variant.question.row)) is None:
        return None
    within = space.envelope(variant.question.known_scene, variant.model, "scene")
    subject = Subject(bench.tool, candidate.library.path, within, budget, candidate.is_batch)
    met = _met(subject, known)
    if met is not None:
        return met
    tool = bench.tool.executable.name
    key = key_of(
        candidate.library.key,
        tool,
        search_hash(variant.question.row),
        SEED,
        EVALUATIONS,
        repr(within),
    )
    bench.progress("searching for errors", 0, 1)
    kept = bench.store.kept("searches", key, lambda: asdict(_sought(subject)))
    bench.progress("searching for errors", 1, 1)
    return Sought(**kept)


def _sought(subject: Subject) -> Sought:
    found = search(subject, Limits(EVALUATIONS), SEED)
    worst = found.over[0] if found.over else found.worst
    return _of(worst, found.evaluations, found.held)


def _of(worst: Finding, evaluations: int, held: bool) -> Sought:
    over = None if worst.kind == "refused" else worst.over
    return Sought(evaluations, SEED, over, held, csv_row("found_by_search", worst.case))


def _met(subject: Subject, cases: Sequence[Array]) -> Sought | None:
    """The worst of known cases, if it is over."""
    if not cases:
        return None
    over = [f for f in errors_confirmed(subject.judge(), np.array(cases)) if counts_as_over(f)]
    return _of(max(over, key=lambda f: f.over), len(cases), False) if over else None


def search_hash(impact: Impact) -> str:
    """Of the rules of the search: what it found holds only under those that it was found by."""
    package = Path(__file__).parents[1]
    evidence, own = package / "evidence", package / "impacts" / impact.folder
    rooms = [evidence / "challenge", evidence / "verification", own / "search", own / "evidence"]
    files: Sequence[Path] = [path for room in rooms for path in sorted(room.rglob("*.py"))]
    return key_of(*(path.read_text("utf-8") for path in files))
