"""A Dask cluster as the lab: jobs go to workers whose CPU is the target, timings alone there.

A worker announces its CPU as a resource, of which it has 1. A build takes a small share of it, a
timing all: so builds run side by side, and none while something is timed. Dask gives what a lost
worker had in hand to another one.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from distributed import Client, Future, wait
from distributed.scheduler import KilledWorker

from ..choice.kernel import Emitted, Rejected, Verified
from ..choice.workbench import TimingJob, Workbench
from ..errors import InputError, KernelError
from ..targets.target import Target
from .lab import Lab
from .worker import (
    Identity,
    Impostor,
    Task,
    build_on_worker,
    identify,
    resource_of,
    time_on_worker,
)

BUILD_SHARE = 1 / 64
_POLL = 0.5  # seconds between two looks at which workers there are
_FETCH = 10.0  # seconds to get the result of a job that is done


class ClusterLab(Lab):
    """Workers of a cluster that are the target's CPU and have the same sources as this clone.

    Raises InputError, also later, where there has been none for `patience` seconds; it names the
    CPU and what the workers there are announce, or are in truth.
    """

    def __init__(
        self,
        client: Client,
        bench: Workbench,
        target: Target,
        patience: float,
        identity: Callable[[], Identity] = identify,
    ) -> None:
        self.client = client
        self.target = target
        self.patience = patience
        self.refused: dict[str, str] = {}  # workers that are not what they announce, and why
        self.jobs: dict[str, int] = {}  # done, by worker
        self._identify = identity
        self._resource = resource_of(target.name)
        self._wanted: Identity | None = None
        self._task = Task(self._wait_for_worker(), identity)
        super().__init__(bench, target)

    def _cpu(self) -> str:
        return f"{self.target.name}, {self._task.expected.cpu}"

    # -- as Lab --

    def build(self, kernels: Sequence[Emitted]) -> Iterator[tuple[Emitted, Verified | Rejected]]:
        for number, made in self._done(build_on_worker, kernels, BUILD_SHARE):
            yield kernels[number], made

    def time(self, job: TimingJob) -> dict[str, Any]:
        [(_, document)] = self._done(time_on_worker, [job], 1.0)
        if isinstance(document, KernelError):
            raise document
        return dict(document)

    # -- workers --

    def _claimants(self) -> dict[str, str]:
        """Names of the workers that announce the CPU, by address, without those refused."""
        info = self.client.scheduler_info()["workers"]
        return {
            address: str(worker["name"])
            for address, worker in info.items()
            if worker["resources"].get(self._resource, 0) >= 1 and address not in self.refused
        }

    def _fits(self, real: Identity) -> str:
        """Empty where a worker may be used, else why not."""
        own = identify()
        if not real.is_target(self.target.name):
            return f"announces {self._resource} and is {real.cpu} ({real.target})"
        if (real.rules, real.bench) != (own.rules, own.bench):
            return "has other sources of carom than this clone"
        if self._wanted is not None and real.cpu != self._wanted.cpu:
            return f"is another {self.target.name} ({real.cpu}) than the first ({self._wanted.cpu})"
        return ""

    def _refuse(self, address: str, name: str, why: str) -> None:
        self.refused[address] = f"worker {name} {why}"

    def _wait_for_worker(self) -> Identity:
        """The first that fits, or InputError; each is asked what it is."""
        end = time.monotonic() + self.patience
        while True:
            for address, name in self._claimants().items():
                real = self._asked(address)
                why = self._fits(real) if isinstance(real, Identity) else real
                if why:
                    self._refuse(address, name, why)
                elif isinstance(real, Identity):
                    self._wanted = real
                    return real
            if time.monotonic() >= end:
                raise InputError(self._nobody())
            time.sleep(_POLL)

    def _asked(self, address: str) -> Identity | str | None:
        """What a worker says it is, or why it cannot; None where it is gone."""
        try:
            told = self.client.run(self._identify, workers=[address], on_error="return")
        except (OSError, ValueError):
            return None
        answer = told.get(address)
        if isinstance(answer, Identity) or answer is None:
            return answer
        return f"cannot say what CPU it is: {answer}"

    def _nobody(self) -> str:
        info = self.client.scheduler_info()["workers"]
        names = sorted({r for worker in info.values() for r in worker["resources"]})
        there = f"workers announce {', '.join(names)}" if names else "no worker announces a CPU"
        false = "".join(f"; {why}" for why in self.refused.values())
        return (
            f"--scheduler: no worker for {self.target.name} in {self.patience:g} s; {there}"
            f"{false}; start one on such a CPU: ./gen worker ADDRESS"
        )

    # -- jobs --

    def _done(
        self, function: Callable[..., Any], payloads: Sequence[Any], share: float
    ) -> Iterator[tuple[int, Any]]:
        """Each payload's number and result as it is done, whatever happens to workers."""
        todo = list(range(len(payloads)))
        pending: dict[Future, _Sent] = {}
        nobody_since: float | None = None
        try:
            while todo or pending:
                able = self._claimants()
                nobody_since = None if able else nobody_since or time.monotonic()
                if nobody_since and time.monotonic() - nobody_since > self.patience:
                    raise InputError(self._nobody())
                todo += _stranded(pending, able)
                while able and todo:
                    number = todo.pop(0)
                    pending.update([self._sent(function, number, payloads[number], share, able)])
                for future in _finished(pending):
                    try:
                        result = self._result(future)
                    except TimeoutError:
                        continue  # its worker was lost with it: the job waits for another one
                    number = pending.pop(future).number
                    if isinstance(result, Impostor):
                        todo.append(number)
                    else:
                        yield number, result
        finally:
            for future in pending:
                future.cancel()

    def _sent(
        self,
        function: Callable[..., Any],
        number: int,
        payload: Any,
        share: float,
        able: Collection[str],
    ) -> tuple[Future, _Sent]:
        workers = frozenset(able) if self.refused else None
        future = self.client.submit(
            _with_address,
            function,
            self._task,
            payload,
            resources={self._resource: share},
            workers=list(workers) if workers else None,
            pure=False,
        )
        return future, _Sent(number, workers)

    def _result(self, future: Future) -> Any:
        """What a worker made. TimeoutError where it does not come: lost, after it was done."""
        try:
            address, result = future.result(timeout=_FETCH)
        except KilledWorker as error:
            raise KernelError(
                f"--scheduler: a job lost every worker it was given: {error}"
            ) from None
        if isinstance(result, Impostor):
            name = self._claimants().get(address, address)
            why = self._fits(result.is_really) or "has changed"
            self._refuse(address, name, why)
        else:
            self.jobs[address] = self.jobs.get(address, 0) + 1
        return result


@dataclass(frozen=True)
class _Sent:
    """A payload on its way; `workers`: to these only, as others were refused."""

    number: int
    workers: frozenset[str] | None


def _stranded(pending: dict[Future, _Sent], able: Collection[str]) -> list[int]:
    """Numbers of what can go to no worker any more, taken back."""
    lost = [f for f, sent in pending.items() if sent.workers and not sent.workers & set(able)]
    for future in lost:
        future.cancel()
    return [pending.pop(future).number for future in lost]


def _with_address(function: Callable[..., Any], *arguments: Any) -> tuple[str, Any]:
    """The result with the worker's address."""
    from distributed import get_worker

    return get_worker().address, function(*arguments)


def _finished(pending: dict[Future, _Sent]) -> list[Future]:
    """Those that are done, after at most a moment."""
    if not pending:
        time.sleep(_POLL)
        return []
    try:
        return list(wait(list(pending), timeout=_POLL, return_when="FIRST_COMPLETED").done)
    except TimeoutError:
        return []
