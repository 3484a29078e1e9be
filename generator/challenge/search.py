"""A search for the largest error of a kernel, and what it found, confirmed and told apart."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from generator.challenge.envelope import Envelope
from generator.challenge.islands import Archipelago, Found
from generator.challenge.judge import ROUNDINGS, Judge
from generator.timing.bench_tool import BenchTool
from generator.verification.errors import STATUS, Array
from generator.verification.floors import rounding_of

LANES = 2  # archipelagos at once: a constant, so that what is found does not depend on the machine
_ISLANDS = 24
_CONFIRMED = 24  # of the best of a search, by the oracle in long double
_EACH = 6  # findings of a kind that are kept
Kind = Literal["error", "refused", "steep", "floor"]


@dataclass(frozen=True)
class Limits:
    """How long a search lasts: evaluations, and the time by which it ends whatever is left."""

    evaluations: int
    until: float = float("inf")  # of time.monotonic()


@dataclass(frozen=True)
class Finding:
    """A case, how far the kernel is off and what kind of thing that is."""

    kind: Kind
    over: float  # error over budget; infinite where it is refused
    error: float  # relative to |v1 - v2|
    moved: float  # how far a rounding of the input moves the exact result
    status: int
    case: Array


@dataclass(frozen=True)
class Result:
    """What a search made of a kernel; each list with the largest first."""

    evaluations: int
    seconds: float
    worst: Finding  # of those that count, over or not
    over: tuple[Finding, ...]  # errors beyond the budget, and valid input that is refused
    apart: tuple[Finding, ...]  # beyond the budget, but steep or under the doubles' floor

    @property
    def held(self) -> bool:
        return not self.over

    @property
    def per_second(self) -> float:
        return self.evaluations / max(self.seconds, 1e-9)


def search(
    tool: BenchTool,
    library: Path,
    within: Envelope,
    budget: float,
    batch: bool,
    limits: Limits,
    seed: int,
    tell: Callable[[int, float], None] = lambda evaluations, best: None,
) -> Result:
    """Look for the largest error. The same seed and evaluations find the same, if time allows.

    `tell` is called after each round, from several threads: evaluations of its lane, best so far.
    """
    start = time.monotonic()

    def lane(index: int) -> tuple[Judge, list[Found]]:
        judge = Judge(tool, library, within, budget, batch)
        sea = Archipelago(within, seed * LANES + index, _ISLANDS)
        while judge.evaluations < limits.evaluations / LANES and time.monotonic() < limits.until:
            sea.round(lambda cases: judge.answers(cases).over)
            tell(judge.evaluations, sea.best)
        return judge, sea.finish()

    with ThreadPoolExecutor(LANES) as pool:
        lanes = list(pool.map(lane, range(LANES)))
    judge = lanes[0][0]
    found = sorted((f for _, each in lanes for f in each), key=lambda f: -f.score)
    cases = np.array([f.case for f in found[:_CONFIRMED]])
    findings = confirmed(judge, cases)
    evaluations = sum(each.evaluations for each, _ in lanes[1:]) + judge.evaluations
    return _result(findings, evaluations, time.monotonic() - start)


def confirmed(judge: Judge, cases: Array) -> list[Finding]:
    """What cases are by the oracle in long double, and why any of them is beyond the budget."""
    answers = judge.answers(cases, "exact")
    floors = rounding_of(cases)
    findings = []
    for row, case in enumerate(cases):
        error, status = float(answers.error[row]), int(answers.got[row, STATUS])
        beyond = error > judge.budget
        moved = judge.moved(case) if beyond and np.isfinite(error) else 0.0
        kind: Kind = "error"
        if answers.got[row, STATUS] != answers.want[row, STATUS]:
            kind = "refused"
        elif beyond and error <= floors[row]:
            kind = "floor"
        elif beyond and moved > judge.budget and error <= ROUNDINGS * moved:
            kind = "steep"
        findings.append(Finding(kind, error / judge.budget, error, moved, status, case))
    return sorted(findings, key=lambda f: -f.over)


def _result(findings: Sequence[Finding], evaluations: int, seconds: float) -> Result:
    counted = [f for f in findings if f.kind in ("error", "refused")]
    apart = tuple(f for f in findings if f.kind in ("steep", "floor"))
    over = tuple(f for f in counted if f.over > 1)
    return Result(evaluations, seconds, (counted or list(apart))[0], over[:_EACH], apart[:_EACH])
