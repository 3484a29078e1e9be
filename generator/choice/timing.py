"""Kernels of a contest timed together: all that the main job has, the best of a sweep."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..errors import KernelCrash, KernelError, KernelTimeout
from ..evidence.timing.rounds import Rounds
from .kernel import Emitted, Reason, Rejected, Verified
from .ties import Standing
from .workbench import TimingJob

PROCESSES = 6  # the range of six covers the median in 97 of 100

Time = Callable[[TimingJob], dict[str, Any]]  # what carom_bench writes; KernelError where it ends


@dataclass(frozen=True)
class Together:
    """What each process measured, and which kernels could not be timed."""

    processes: tuple[dict[str, Any], ...]
    ended: tuple[Rejected, ...] = ()

    @property
    def rounds(self) -> Rounds:
        return Rounds.of(self.processes)


def timed_together(time: Time, job: TimingJob, tell: Callable[[int, int], None]) -> Together:
    """A job in `PROCESSES` processes; where a kernel ends one, those that can be timed alone.

    `tell`: of how many kernels and which process begins.
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


def _processes(
    time: Time, job: TimingJob, tell: Callable[[int, int], None]
) -> tuple[dict[str, Any], ...]:
    """All kernels in another order each time, the baseline always first."""
    first, documents = job.baseline, []
    others = [kernel for kernel in job.kernels if kernel.name != first.name]
    for number in range(PROCESSES):
        tell(len(job.kernels), number + 1)
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
