"""Kernels of a contest timed together: all that the main job has, the best of a sweep."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from ..errors import KernelCrash, KernelError, KernelTimeout
from ..evidence.timing.ratios import timing_results
from ..evidence.timing.rounds import Rounds
from .cases import Progress
from .kernel import Built, Emitted, Reason, Rejected, Timed, Verified
from .ties import Standing
from .workbench import TimingJob

PROCESSES = 6  # the range of six covers the median in 97 of 100
ROUNDS = 1000  # at most, in each; the seconds end a timing before

Time = Callable[[TimingJob], dict[str, Any]]  # what carom_bench writes; KernelError where it ends


@dataclass(frozen=True)
class Together:
    """What each process measured, and which kernels could not be timed."""

    processes: tuple[dict[str, Any], ...]
    ended: tuple[Rejected, ...] = ()

    @cached_property
    def rounds(self) -> Rounds:
        return Rounds.of(self.processes)

    def told(self, kernels: Sequence[Verified | Rejected]) -> list[Timed | Rejected]:
        """Kernels of the job with their times; what ended it is rejected."""
        results = {result.name: result for result in timing_results(self.rounds.whole)}
        ended = {rejected.name: rejected for rejected in self.ended}
        return [
            k if isinstance(k, Rejected) else ended.get(k.name) or k.timed(results[k.name])
            for k in kernels
        ]


def job_of(kernels: Sequence[Verified | Rejected], seconds: float) -> TimingJob:
    """All that passed and the first, the baseline, each once. KernelError where nothing is left."""
    passed = [k for k in kernels if not isinstance(k, Rejected)]
    first = kernels[0].emitted
    if not passed or not isinstance(first, Built):
        reasons = sorted({k.text for k in kernels if isinstance(k, Rejected)})
        raise KernelError(f"no candidate passed verification: {'; '.join(reasons[:3])}")
    unique = {kernel.name: kernel for kernel in (first, *passed)}
    return TimingJob(tuple(unique.values()), ROUNDS, seconds / PROCESSES, latency=True)


def timed_together(time: Time, job: TimingJob, tell: Progress) -> Together:
    """A job in `PROCESSES` processes; where a kernel ends one, those that can be timed alone.

    `tell` is told of each process as it begins.
    """
    try:
        return Together(_processes(time, job, tell))
    except KernelError:
        ended = tuple(_ending(time, job))
    names = {rejected.name for rejected in ended}
    left = tuple(kernel for kernel in job.kernels[1:] if kernel.name not in names)
    if not left:
        raise KernelError("no kernel could be timed alone; is the machine in order?")
    return Together(_processes(time, replace(job, kernels=(job.baseline, *left)), tell), ended)


def _processes(time: Time, job: TimingJob, tell: Progress) -> tuple[dict[str, Any], ...]:
    """All kernels in another order each time, the baseline always first."""
    first, documents = job.baseline, []
    what = f"timing {len(job.kernels)} kernels for {PROCESSES * job.seconds:.0f} s"
    others = [kernel for kernel in job.kernels if kernel.name != first.name]
    for number in range(PROCESSES):
        tell(what, number, PROCESSES)
        shift = number * len(others) // PROCESSES
        documents.append(time(replace(job, kernels=(first, *others[shift:], *others[:shift]))))
    return tuple(documents)


def _ending(time: Time, job: TimingJob) -> Iterator[Rejected]:
    """Those that cannot be timed alone."""
    for kernel in job.kernels[1:]:
        try:
            time(replace(job, kernels=(job.baseline, kernel)))
        except KernelError as error:
            yield ended_by(kernel, error)


def standings_of(rounds: Rounds, kernels: Sequence[Verified]) -> tuple[str, list[Standing]]:
    """The name of the fastest, and how each kernel stands to it."""
    best = rounds.fastest([kernel.name for kernel in kernels])
    return best, [
        Standing(k.variant, rounds.ratio(k.name, best)[0], rounds.apart(k.name, best))
        for k in kernels
    ]


def ended_by(kernel: Emitted, error: KernelError) -> Rejected:
    """A kernel that was not timed to the end."""
    reason: Reason = "timeout" if isinstance(error, KernelTimeout) else "crash"
    if not isinstance(error, KernelCrash | KernelTimeout):
        reason = "wrong result"  # the bench refused what it gave
    return Rejected(kernel, reason, f"timing: {error}")
