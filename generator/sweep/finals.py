"""The best of a contest interleaved: which is chosen, and whether that holds.

A final is timed in several processes, since where the loader puts a library shifts its time by more
than the rounds of one process tell. Intervals are the range of what the processes gave.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from ..choice.kernel import Verified
from ..choice.ties import Standing, pick
from ..choice.timing import PROCESSES, standings_of, timed_together
from ..choice.trials import (
    Final,
    Finalist,
    Rejection,
    Subject,
    Times,
    job_key,
    rounded,
)
from ..choice.workbench import BLOCK_MS, TimingJob
from ..evidence.timing.rounds import Rounds
from ..registry.names import name_of
from .explore import Exploration
from .ladder import Entry, finalists

FINAL_ROUNDS = 120  # in each
FINAL_SECONDS = 8.0
CLEARLY = 1.03  # a kernel that is faster than the choice by more than this beats it

Purpose = Literal["choice", "verify-choice"]


@dataclass(frozen=True)
class Beaten:
    """A kernel that was faster than the choice in a re-timing; `gain` of 1.05 is by 5 %."""

    name: str
    gain: float
    clear: bool


def choose(exploration: Exploration) -> Final | None:
    """The choice among the finalists, from the store if the same were timed before."""
    entries = finalists(list(exploration.entries.values()))
    return hold(exploration, entries, "choice") if entries else None


def hold(
    exploration: Exploration,
    entries: Sequence[Entry],
    purpose: Purpose,
    rounds: int = FINAL_ROUNDS,
    chosen: str = "",
) -> Final:
    """Time entries against each other. `chosen`: the choice that is looked at again."""
    exploration.tell(f"timing {len(entries)} against each other")
    pairs = exploration.built(entries)
    timing = f"{rounds} rounds, blocks of {BLOCK_MS:g} ms, {PROCESSES} processes"
    key = job_key(purpose, (exploration.depends(e.variant, timing) for e, _ in pairs))
    known = exploration.ledger.find_final(key) if purpose == "choice" else None
    if known is not None:
        return known
    kernels = [kernel for _, kernel in pairs]
    timed = _timed(exploration, kernels, rounds)
    there = {k.name: k for k in kernels if k.name in timed.whole.throughput.ns}
    best, standings = standings_of(timed, list(there.values()))
    rows = [_finalist(there[each.name], each, timed, best) for each in standings]
    return exploration.ledger.final(
        key,
        contest=str(exploration.contest),
        purpose=purpose,
        chosen=chosen or name_of(pick(standings)),
        fastest=best,
        finalists=tuple(sorted(rows, key=lambda row: (row.to_fastest, row.subject.name))),
        rounds=timed.whole.rounds,
        processes=len(timed.runs),
        control=timed.control,
    )


def _timed(exploration: Exploration, kernels: Sequence[Verified], rounds: int) -> Rounds:
    """All of them together; those that end that are dropped."""

    def tell(what: str, done: int, of: int) -> None:
        exploration.tell(f"{what}, process {done + 1} of {of}")

    job = TimingJob((exploration.baseline, *kernels), rounds, FINAL_SECONDS)
    made = timed_together(exploration.lab.time, job, tell)
    for rejected in made.ended:
        exploration.drop(rejected.variant, Rejection.of(rejected))
    return made.rounds


def _finalist(kernel: Verified, standing: Standing, timed: Rounds, best: str) -> Finalist:
    error, (_, (low, high)) = kernel.verdict.max_rel_error, timed.ratio(kernel.name, best)
    return Finalist(
        subject=Subject.of(kernel.variant),
        times=Times.of(timed.whole, kernel.name),
        to_fastest=rounded(standing.ratio),
        to_fastest_ci=(rounded(low), rounded(high)),
        distance=kernel.variant.distance_from_default(),
        max_rel_error=error if math.isfinite(error) else None,
        tie=standing.ties,
    )


def beaten_by(final: Final) -> list[Beaten]:
    """Kernels that were faster than the choice, and whether clearly: by more than 3 %."""
    own = final.row(final.chosen).to_fastest
    found = []
    for row in final.finalists:
        gain = own / row.to_fastest
        if row.subject.name != final.chosen and gain > 1:
            found.append(Beaten(row.subject.name, gain, gain > CLEARLY))
    return found
