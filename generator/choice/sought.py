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
SEARCHES = 8  # for one choice, at most


@dataclass(frozen=True)
class Sought:
    """What a short search found of a kernel."""

    evaluations: int
    seed: int
    over: float | None  # largest error over the budget; None: valid input is refused
    held: bool
    case: str  # a row in the columns of reference/inputs.csv
    known: bool = False  # did a case that was known show it, without a search?

    def told(self) -> str:
        """For the summary and for selection.json."""
        largest = "valid input refused" if self.over is None else f"{self.over:.3g} of the budget"
        verdict = "" if self.held else "OVER: "
        return f"{verdict}{largest}, {self.evaluations} evaluations, seed {self.seed}"


def choose_sought(bench: Workbench, kernels: Entries, choose: Choose) -> tuple[Entries, Choice]:
    """The first choice that holds under the worst root estimates, and a short search.

    What does not is rejected and the next is chosen, which meets the cases found so far first: what
    they show costs no search. Only where none that may be chosen holds, or `SEARCHES` have
    found none, the one that is least over of those searched stands, and says so.
    """
    over: list[tuple[float, Choice]] = []
    known: list[Array] = []
    left, searches = kernels, 0
    while searches < SEARCHES:
        try:
            left, choice = _held_at_worst(bench, left, choose)
        except KernelError:
            if not over:
                raise
            break
        found = sought(bench, choice.chosen, known)
        if found is None:
            return left, choice
        case = "" if found.held else f"; case {found.case}"
        choice = replace(choice, sought=found.told() + case)
        if found.held:
            return left, choice
        if not found.known:  # a known case says nothing of how far over a kernel may be
            searches += 1
            over.append((float("inf") if found.over is None else found.over, choice))
        known.append(np.array(found.case.split(",")[2:], dtype=np.float64))
        left = _with(left, Rejected(choice.chosen, "search", f"search: {found.told()}"))
    _, least = min(over, key=lambda each: each[0])
    return _with(left, least.chosen), least


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
    if not over:
        return None
    return replace(_of(max(over, key=lambda f: f.over), len(cases), False), known=True)


def search_hash(impact: Impact) -> str:
    """Of the rules of the search: what it found holds only under those that it was found by."""
    package = Path(__file__).parents[1]
    evidence, own = package / "evidence", package / "impacts" / impact.folder
    rooms = [evidence / "challenge", evidence / "verification", own / "search", own / "evidence"]
    files: Sequence[Path] = [path for room in rooms for path in sorted(room.rglob("*.py"))]
    return key_of(*(path.read_text("utf-8") for path in files))
