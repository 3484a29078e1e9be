"""The best of a contest interleaved: which is chosen, and whether that holds.

A final is timed in several processes, since where the loader puts a library shifts its time by more
than the rounds of one process tell. Intervals are the range of what the processes gave.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..choice.workbench import Candidate
from ..errors import KernelError
from ..evidence.records.code import digest
from ..evidence.records.evidence import NEGLIGIBLE, WON
from ..evidence.timing.ratios import Interval, TimingRun, control_band, joined, timing_run
from .explore import Exploration
from .figures import errors_of, rounded, times_of
from .ladder import RUNGS, Entry, finalists
from .record import Final, Finalist
from .sources import candidate_hash
from .station import BLOCK_MS, TimingJob, rejection_of

PROCESSES = 6  # the range of six covers the median in 97 of 100
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


@dataclass(frozen=True)
class Rounds:
    """The processes of a final."""

    runs: tuple[TimingRun, ...]
    whole: TimingRun

    def ratio(self, name: str, other: str) -> tuple[float, Interval]:
        """The median of the processes' median ratios, and their range."""
        times = [run.throughput.ns for run in self.runs]
        medians = [float(np.median(ns[name] / ns[other])) for ns in times]
        return float(np.median(medians)), (min(medians), max(medians))

    def fastest(self, names: Sequence[str]) -> str:
        """The one that none of the others beats, kernel against kernel in the same rounds.

        Where they beat each other in a circle, the one at which it closes.
        """
        best, been = names[0], set[str]()
        while best not in been:
            been.add(best)
            ratios = {name: self.ratio(name, best)[0] for name in names}
            best = min(names, key=lambda name: (ratios[name], name != best, name))
        return best

    def control(self) -> Interval:
        """The A/A band over all rounds."""
        return control_band(self.whole)

    def ties(self, name: str, best: str) -> bool:
        """Can a kernel not be told from the fastest, or by less than matters?

        As timing.ratios has it, over processes. Without the second, and without a margin over what
        may be chosen, each of two sweeps could choose one that the other names no tie.
        """
        ratio, (least, most) = self.ratio(name, best)
        low, high = self.control()
        return low <= ratio <= high or least <= 1 <= most or ratio <= WON


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
    key = _key(exploration, [c for _, c in pairs], rounds, purpose)
    known = exploration.ledger.find_final(key) if purpose == "choice" else None
    if known is not None:
        return known
    try:
        timed = _timed(exploration, [c for _, c in pairs], rounds)
    except KernelError:
        pairs = _weeded(exploration, pairs)
        timed = _timed(exploration, [c for _, c in pairs], rounds)
    best = timed.fastest([c.name for _, c in pairs])
    rows = [_finalist(exploration, *pair, timed, best) for pair in pairs]
    close = [row for row in rows if row.to_fastest <= NEGLIGIBLE]
    preferred = min(close, key=lambda row: (row.distance, row.subject.name)).subject.name
    return exploration.ledger.final(
        key,
        contest=exploration.contest.name,
        purpose=purpose,
        chosen=chosen or preferred,
        fastest=best,
        finalists=tuple(sorted(rows, key=lambda row: (row.to_fastest, row.subject.name))),
        rounds=timed.whole.rounds,
        processes=len(timed.runs),
        control=timed.control(),
    )


def _timed(exploration: Exploration, candidates: Sequence[Candidate], rounds: int) -> Rounds:
    """All of them in each process, in another order each time, the baseline always first."""
    first, runs = exploration.baseline, []
    others = [c for c in candidates if c.name != first.name]
    for number in range(PROCESSES):
        exploration.tell(f"timing {len(candidates)} together, process {number + 1} of {PROCESSES}")
        shift = number * len(others) // PROCESSES
        order = (first, *others[shift:], *others[:shift])
        job = TimingJob(order, rounds, FINAL_SECONDS)
        runs.append(timing_run(exploration.lab.time(job)))
    return Rounds(tuple(runs), joined(runs))


def _weeded(
    exploration: Exploration, pairs: Sequence[tuple[Entry, Candidate]]
) -> list[tuple[Entry, Candidate]]:
    """Those that can be timed alone: one of them has ended the process of all."""
    sound = []
    for entry, candidate in pairs:
        job = TimingJob((exploration.baseline, candidate), RUNGS[-1], FINAL_SECONDS)
        try:
            exploration.lab.time(job)
        except KernelError as error:
            exploration.drop(entry.variant, rejection_of(error))
        else:
            sound.append((entry, candidate))
    if not sound:
        raise KernelError("no finalist could be timed alone; is the machine in order?")
    return sound


def _key(
    exploration: Exploration, candidates: Sequence[Candidate], rounds: int, purpose: Purpose
) -> str:
    first = candidates[0]
    rules = exploration.lab.rules(first.variant.stepper.steps, first.is_batch)
    return digest(
        [
            sorted(candidate_hash(c) for c in candidates),
            candidate_hash(exploration.baseline),
            exploration.lab.cpu,
            exploration.contest.call,
            [purpose, rounds, PROCESSES, BLOCK_MS, rules.cases, rules.bench],
        ]
    )


def _finalist(
    exploration: Exploration, entry: Entry, candidate: Candidate, timed: Rounds, best: str
) -> Finalist:
    ratio, (low, high) = timed.ratio(candidate.name, best)
    errors = errors_of(candidate)
    return Finalist(
        subject=exploration.contest.subject(entry.variant),
        times=times_of(timed.whole, candidate.name),
        to_fastest=rounded(ratio),
        to_fastest_ci=(rounded(low), rounded(high)),
        distance=entry.variant.distance_from_default(),
        max_rel_error=errors.max_rel_error if errors else None,
        tie=timed.ties(candidate.name, best),
    )


def row_of(final: Final, name: str) -> Finalist:
    """A finalist by the name it had then."""
    for row in final.finalists:
        if row.subject.name == name:
            return row
    raise KernelError(f"{name} was not timed in this final")


def beaten_by(final: Final) -> list[Beaten]:
    """Kernels that were faster than the choice, and whether clearly: by more than 3 %."""
    own = row_of(final, final.chosen).to_fastest
    found = []
    for row in final.finalists:
        gain = own / row.to_fastest
        if row.subject.name != final.chosen and gain > 1:
            found.append(Beaten(row.subject.name, gain, gain > CLEARLY))
    return found
