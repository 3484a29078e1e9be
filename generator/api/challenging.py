"""Searches for the input with the largest error of a kernel."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from ..choice.lookup import require_runs, with_compiler_found
from ..choice.workbench import Workbench
from ..errors import InputError
from ..evidence.challenge.document import document
from ..evidence.challenge.kept import keep as keep_cases
from ..evidence.challenge.place import search_of
from ..evidence.challenge.search import Limits, Result, Subject, search_all
from ..evidence.profiling.counting import count_evaluations
from ..evidence.verification.errors import Array
from ..evidence.verification.evidence import evidence_of
from ..registry.names import name_of
from ..registry.question import DEFAULT_IMPACT, find_impact
from ..registry.variant import Variant
from ..targets.target import find_target
from .request import Request, kernel_named
from .session import Session, resolve_target

Extent = Literal["real", "scene"]
MOST_EVALUATIONS = 2**62  # where the time alone ends a search
_BUDGETS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-9)  # of `everything`


@dataclass(frozen=True)
class ChallengeRequest:
    """What to search, and for how long.

    `request`: whose chosen kernel; or `kernel`, by its name. `everything`: all models and budgets
    that the request does not name, single calls and batches. `extent`: inputs that occur in play
    ("real"), or all that the scene documents. A search of a kernel ends after `minutes`, or after
    so many `evaluations`: the same `seed` then finds the same.
    """

    request: Request = field(default_factory=Request)
    kernel: str | None = None
    everything: bool = False
    extent: Extent = "scene"
    minutes: float | None = None
    evaluations: int | None = None
    seed: int = 1

    def limits(self) -> Limits:
        """When a search that begins now ends."""
        if self.evaluations is not None:
            return Limits(self.evaluations)
        return Limits(MOST_EVALUATIONS, time.monotonic() + 60 * (self.minutes or 1.0))

    def kernels(self, session: Session) -> list[tuple[Variant, bool]]:
        """The kernels to search, and whether their batches are. Raises InputError."""
        if self.everything and self.kernel:
            raise InputError("--all and a kernel exclude each other: name one of them")
        if self.minutes is not None and self.evaluations is not None:
            raise InputError("--minutes and --evaluations exclude each other: name one of them")
        if self.kernel is not None:
            variant = _named(self.kernel, session)
            return [(variant, self.request.batch or variant.width > 1)]
        asked = self.request
        models, budgets, calls = [asked.model], [asked.max_error], [asked.batch]
        if self.everything:
            calls = [False, True]
            models = (
                [asked.model]
                if asked.model
                else [m.name for m in find_impact(asked.impact).model_table()]
            )
            budgets = [asked.max_error] if asked.max_error else [*_BUDGETS]
        wanted = [
            replace(asked, model=model, max_error=budget, batch=batch).resolved()
            for model in models
            for budget in budgets
            for batch in calls
        ]
        return [(each.kernel(session), each.request.batch) for each in wanted]


@dataclass(frozen=True)
class Challenged:
    """What the hunts found of one kernel; the first hunt is that for errors."""

    kernel: str
    subject: Subject
    seed: int
    results: tuple[Result, ...]
    document: dict[str, Any]

    @property
    def held(self) -> bool:
        """Was nothing over?"""
        return all(result.held for result in self.results)


def challenge(
    asked: ChallengeRequest | None = None, session: Session | None = None
) -> Iterator[Challenged]:
    """Search kernel after kernel for the largest error, jumps, lost symmetry, the slowest input.

    Raises InputError where the request cannot be, KernelError where a kernel cannot run here.
    """
    session, asked = session or Session(), asked or ChallengeRequest()
    wanted = asked.kernels(session)
    search_of(wanted[0][0].question.row)  # there must be one
    resolved, host = resolve_target(wanted[0][0].target)
    require_runs(host, resolved)
    with session.workbench(target=resolved, impact=wanted[0][0].question.row) as bench:
        for variant, batch in wanted:
            subject = _subject(bench, variant, batch, asked.extent)
            found = search_all(subject, asked.limits(), asked.seed)
            told = document(variant, subject, asked.seed, host.cpu, found)
            yield Challenged(told["kernel"], subject, asked.seed, tuple(found), told)


def keep(found: Sequence[Result], impact: str = DEFAULT_IMPACT) -> tuple[int, int]:
    """Add the worst case of each result that is over to the kept cases: new ones, of how many."""
    over = [("found_by_search", result.over[0].case) for result in found if result.over]
    if not over:
        return 0, 0
    row = find_impact(impact)
    return keep_cases(over, evidence_of(row).hard_cases, row.columns.case), len(over)


def _named(kernel: str, session: Session) -> Variant:
    variant = kernel_named(kernel, session)
    if variant.stepper.budget is None:
        raise InputError(f"{kernel}: has fixed steps and no error budget; name an exact kernel")
    return variant


def _subject(bench: Workbench, variant: Variant, batch: bool, extent: Extent) -> Subject:
    budget = variant.stepper.budget
    if budget is None:
        raise InputError(f"{name_of(variant)}: has no error budget; name an exact kernel")
    variant = with_compiler_found(variant, dict(bench.compilers))
    candidate = bench.built(variant, find_target(variant.target))
    cache = bench.cache / "kernels"

    def count(cases: Array) -> Array:
        own = (candidate.source, candidate.compiler, candidate.flags)
        return np.array(count_evaluations(*own, cases, cache), dtype=np.float64)

    asked = variant.question
    within = search_of(asked.row).envelope(asked.known_scene, asked.model, extent)
    library = candidate.library.path
    return Subject(bench.tool, library, within, budget, batch, None if batch else count)
