"""The same kernels timed together in several processes, and which of them can be told apart.

Where the loader puts a library shifts its time by more than the rounds of one process tell. So
intervals are the range of what the processes gave; those of one process are its rounds'.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from .ratios import (
    Interval,
    Measurement,
    TimingRun,
    control_band,
    median_interval,
    ratio_between,
    timing_run,
)


@dataclass(frozen=True)
class Rounds:
    """The processes of a timing."""

    runs: tuple[TimingRun, ...]

    @staticmethod
    def of(documents: Sequence[dict[str, Any]]) -> Rounds:
        """What carom_bench wrote. Raises KernelError where something is missing."""
        return Rounds(tuple(timing_run(document) for document in documents))

    @cached_property
    def whole(self) -> TimingRun:
        """All rounds, one process after the other."""
        first, rounds = self.runs[0], sum(run.rounds for run in self.runs)
        return replace(
            first,
            rounds=rounds,
            throughput=_joined([run.throughput for run in self.runs]),
            latency=self._each(lambda run: run.latency),
            seed_cases=self._each(lambda run: run.seed_cases),
            quiet=sum(run.quiet * run.rounds for run in self.runs) / rounds,
        )

    def _each(self, part: Callable[[TimingRun], Measurement | None]) -> Measurement | None:
        found = [one for run in self.runs if (one := part(run)) is not None]
        return _joined(found) if len(found) == len(self.runs) else None

    def ratio(self, name: str, other: str) -> tuple[float, Interval]:
        """The median of the processes' median ratios, and its interval."""
        medians = [ratio_between(run, name, other) for run in self.runs]
        if len(self.runs) > 1:
            return float(np.median(medians)), (min(medians), max(medians))
        ns = self.runs[0].throughput.ns
        return medians[0], median_interval(ns[name] / ns[other])

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

    @cached_property
    def control(self) -> Interval:
        """The A/A band over all rounds."""
        return control_band(self.whole)

    def apart(self, name: str, best: str) -> bool:
        """Can a kernel be told from the fastest?

        Not where their ratio is one that the baseline has to itself, or where the interval of the
        ratio does not say which of them is faster.
        """
        ratio, (least, most) = self.ratio(name, best)
        low, high = self.control
        return not (low <= ratio <= high or least <= 1 <= most)


def _joined(parts: Sequence[Measurement]) -> Measurement:
    """The rounds of several measurements of the same kernels one after the other."""
    names = list(parts[0].ns)
    return Measurement(
        ns={name: np.concatenate([part.ns[name] for part in parts]) for name in names},
        ticks={name: np.concatenate([part.ticks[name] for part in parts]) for name in names},
        control=np.concatenate([part.control for part in parts]),
    )
