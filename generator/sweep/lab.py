"""Where a sweep's jobs are done: here, or on a cluster. Compiling side by side, timing alone."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import Any, Protocol

from ..choice.workbench import Candidate
from ..registry.variant import Variant
from ..targets.target import Target
from .record import Rejection
from .station import Code, Rules, Station, TimingJob


class Lab(Protocol):
    """What a sweep needs done. Candidates get their library and verdict in place."""

    @property
    def cpu(self) -> str:
        """The target and the model name of the CPU that times."""

    @property
    def compilers(self) -> dict[str, str]:
        """Versions by axis code."""

    def rules(self, steps: int | None, batches: bool) -> Rules:
        """What figures depend on besides the kernel."""

    def code(self, variant: Variant) -> Code:
        """What the compiler would be given. Raises EmissionError, as `candidate` does."""

    def candidate(self, variant: Variant) -> Candidate:
        """Emitted; its library is made by `build`.

        Raises EmissionError where it cannot be laid out, though no rule says so.
        """

    def build(
        self, candidates: Sequence[Candidate]
    ) -> Iterator[tuple[Candidate, Rejection | None]]:
        """Compile and verify, side by side; each as it is done. Nothing runs when it ends."""

    def time(self, job: TimingJob) -> dict[str, Any]:
        """What carom_bench measured, alone on the machine, as far as that is ours to say.

        Raises KernelError where a kernel of the job ends it.
        """


class StationLab:
    """What labs have in common: texts and rules are made here, wherever the jobs are done."""

    def __init__(self, station: Station, target: Target) -> None:
        self.station = station
        self.target = target
        self.compilers = {c.code: c.version for c in station.bench.compilers.values()}

    def rules(self, steps: int | None, batches: bool) -> Rules:
        return self.station.rules(steps, batches)

    def code(self, variant: Variant) -> Code:
        return self.station.code(variant, self.target)

    def candidate(self, variant: Variant) -> Candidate:
        return self.station.emit(variant, self.target)


class LocalLab(StationLab):
    """This machine."""

    def __init__(self, station: Station, target: Target, workers: int | None = None) -> None:
        super().__init__(station, target)
        self.workers = workers or os.cpu_count() or 1
        self.cpu = f"{target.name}, {station.host().cpu}"

    def build(
        self, candidates: Sequence[Candidate]
    ) -> Iterator[tuple[Candidate, Rejection | None]]:
        def work(candidate: Candidate) -> Rejection | None:
            return self.station.compile(candidate) or self.station.verify(candidate)

        for steps in {c.variant.stepper.steps for c in candidates}:
            self.station.expected(steps)  # made once, not by each thread
        yield from side_by_side(work, candidates, self.workers)

    def time(self, job: TimingJob) -> dict[str, Any]:
        return self.station.time(job)


def side_by_side(
    work: Callable[[Candidate], Rejection | None], candidates: Sequence[Candidate], workers: int
) -> Iterator[tuple[Candidate, Rejection | None]]:
    """Each candidate with its result as it is done; an interruption drops what has not begun."""
    pool = ThreadPoolExecutor(workers)
    try:
        futures = {pool.submit(work, candidate): candidate for candidate in candidates}
        for future in as_completed(futures):
            yield futures[future], future.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
