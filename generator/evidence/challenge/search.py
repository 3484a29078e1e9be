"""A search for what a kernel does worst, and what it found, confirmed and told apart."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from ..timing.bench_tool import BenchTool
from ..verification.errors import Array
from .hunts import Hunt, jumps, score_of
from .islands import Archipelago, Found
from .judge import ROUNDINGS, Judge
from .place import Within

LANES = 2  # archipelagos at once: a constant, so that what is found does not depend on the machine
_ISLANDS = 24
_CONFIRMED = 24  # of the best of a search, by the oracle in long double
_REFUSED = 3  # of them may be cases that were refused
_EACH = 6  # findings of a kind that are kept
Kind = Literal["error", "refused", "steep", "floor", "jump", "energy", "symmetry", "slow"]


@dataclass(frozen=True)
class Subject:
    """What is searched: a kernel in a library, where, and what it promises."""

    tool: BenchTool
    library: Path
    within: Within
    budget: float
    batch: bool
    count: Callable[[Array], Array] | None = None  # evaluations that it makes for each case

    def judge(self) -> Judge:
        return Judge(self.tool, self.library, self.within, self.budget, self.batch)


@dataclass(frozen=True)
class Limits:
    """How long a search lasts: evaluations, and the time by which it ends whatever is left."""

    evaluations: float
    until: float = float("inf")  # of time.monotonic()


@dataclass(frozen=True)
class Finding:
    """A case, how far the kernel is off and what kind of thing that is."""

    kind: Kind
    over: float  # what was looked for, over its limit; infinite where the case is refused
    moved: float  # how far a rounding of the input moves the exact result, relative
    status: int
    case: Array


@dataclass(frozen=True)
class Result:
    """What a search made of a kernel; each list with the largest first."""

    hunt: Hunt
    evaluations: int
    seconds: float
    worst: Finding  # of those that count, over or not
    over: tuple[Finding, ...]  # beyond the limit, or valid input that is refused
    apart: tuple[Finding, ...]  # beyond it, but steep or under the doubles' floor

    @property
    def held(self) -> bool:
        return not self.over


def search(
    subject: Subject,
    limits: Limits,
    seed: int,
    hunt: Hunt = "error",
    tell: Callable[[int, float], None] = lambda evaluations, best: None,
) -> Result:
    """Look for the largest of what `hunt` says. Same seed and evaluations, same findings.

    `tell` is called after each round, from several threads: evaluations of its lane, best so far.
    There is a first round even where the time is over, so that there is something to tell.
    """
    start = time.monotonic()

    def lane(index: int) -> tuple[Judge, list[Found]]:
        judge = subject.judge()
        score = score_of(hunt, judge, subject.count)
        sea = Archipelago(judge.space, subject.within, seed * LANES + index, _ISLANDS)
        again = True
        while again:
            sea.round(score)
            tell(judge.evaluations, sea.best)
            left = judge.evaluations < limits.evaluations / LANES
            again = left and time.monotonic() < limits.until
        return judge, sea.finish()

    with ThreadPoolExecutor(LANES) as pool:
        lanes = list(pool.map(lane, range(LANES)))
    judge = subject.judge()
    findings = confirmed(judge, hunt, _best([f for _, found in lanes for f in found]))
    evaluations = judge.evaluations + sum(each.evaluations for each, _ in lanes)
    return _result(hunt, findings, evaluations, time.monotonic() - start)


def _best(found: Sequence[Found]) -> list[Found]:
    """The largest of what was found, with a few of the cases that were refused."""
    ordered = sorted(found, key=lambda f: -f.score)
    refused = [f for f in ordered if np.isinf(f.score)][:_REFUSED]
    return [*refused, *(f for f in ordered if np.isfinite(f.score))][:_CONFIRMED]


def confirmed(judge: Judge, hunt: Hunt, found: Sequence[Found]) -> list[Finding]:
    """What the best of a search are when looked at closely, largest first."""
    cases = np.array([f.case for f in found])
    if hunt == "error":
        findings = errors_confirmed(judge, cases)
    elif hunt == "jump":
        cases, sizes = jumps(judge, cases)
        findings = [_moved(judge, f) for f in _plain(judge, "jump", cases, sizes)]
    else:
        findings = _plain(judge, hunt, cases, np.array([f.score for f in found]))
    return sorted(findings, key=lambda f: -f.over)


def errors_confirmed(judge: Judge, cases: Array) -> list[Finding]:
    """Errors by the oracle in long double, and why any of them is beyond the budget."""
    answers = judge.answers(cases, "exact")
    floors, column = judge.measure.rounding_of(cases), judge.columns.status
    findings = []
    for row, case in enumerate(cases):
        error, status = float(answers.error[row]), int(answers.got[row, column])
        beyond = error > judge.budget
        moved = judge.moved(case) if beyond and np.isfinite(error) else 0.0
        kind: Kind = "error"
        if status != answers.want[row, column]:
            kind = "refused"
        elif beyond and error <= floors[row]:
            kind = "floor"
        elif beyond and moved > judge.budget and error <= ROUNDINGS * moved:
            kind = "steep"
        findings.append(Finding(kind, error / judge.budget, moved, status, case))
    return findings


def counts_as_over(finding: Finding) -> bool:
    """Does it break what a kernel promises?"""
    return finding.over > 1 and finding.kind not in ("steep", "floor", "slow")


def _plain(judge: Judge, kind: Kind, cases: Array, sizes: Array) -> list[Finding]:
    status = judge.run(cases)[:, judge.columns.status]
    rows = zip(sizes, status, cases, strict=True)
    return [Finding(kind, float(size), 0.0, int(code), case) for size, code, case in rows]


def _moved(judge: Judge, finding: Finding) -> Finding:
    """A jump where the exact result is steep itself is told apart."""
    if finding.over <= 1:
        return finding
    moved = judge.moved(finding.case)
    steep = moved > judge.budget / 10
    return replace(finding, moved=moved, kind="steep" if steep else finding.kind)


def _result(hunt: Hunt, findings: Sequence[Finding], evaluations: int, seconds: float) -> Result:
    apart = tuple(f for f in findings if f.kind in ("steep", "floor"))
    counted = [f for f in findings if f.kind not in ("steep", "floor")]
    over = tuple(f for f in counted if counts_as_over(f))
    worst = (counted or list(apart))[0]
    return Result(hunt, evaluations, seconds, worst, over[:_EACH], apart[:_EACH])


SHARES: dict[Hunt, float] = {
    "error": 0.6,
    "jump": 0.2,
    "energy": 0.06,
    "symmetry": 0.07,
    "slow": 0.07,
}


def search_all(subject: Subject, limits: Limits, seed: int) -> list[Result]:
    """Every hunt in turn, each with its share; the slowest input where evaluations are counted."""
    results, begun = [], time.monotonic()
    whole, spent = limits.until - begun, 0.0
    for hunt, share in SHARES.items():
        if hunt == "slow" and subject.count is None:
            continue
        spent += share
        part = Limits(limits.evaluations * share, begun + whole * spent)
        results.append(search(subject, part, seed, hunt))
    return results
