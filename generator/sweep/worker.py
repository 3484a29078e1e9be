"""What a worker of a cluster does for a sweep. It has a clone of its own, with its own cache."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from ..choice.workbench import Candidate, Workbench, verification_hash
from ..errors import KernelError
from ..evidence.timing.bench_tool import build_bench_tool, source_hash
from ..impacts.registry import DEFAULT, find_impact
from ..places import cache_folder
from ..targets.host import read_host
from ..toolchain.compilers import find_compilers
from .record import Rejection
from .station import Station, TimingJob


@dataclass(frozen=True)
class Identity:
    """What a worker really is, whatever it announces."""

    target: str
    exact: bool  # is the target this CPU, or only its nearest ancestor?
    cpu: str  # model name
    rules: str  # hashes of the rules of verification and of the bench
    bench: str

    def is_target(self, name: str) -> bool:
        return self.exact and self.target == name


def resource_of(target: str) -> str:
    """The name of the resource by which a worker announces its CPU; it has 1 of it."""
    return f"cpu-{target}"


def identify() -> Identity:
    """This machine, read from /proc/cpuinfo and from the sources."""
    host = read_host()
    bench = source_hash(find_impact(DEFAULT))
    return Identity(host.target.name, host.exact, host.cpu, verification_hash(), bench)


@dataclass(frozen=True)
class Task:
    """One job as it is sent. A worker that turns out not to be `expected` does not do it."""

    scene: str
    model: str
    expected: Identity
    identify: Callable[[], Identity]


@dataclass(frozen=True)
class Impostor:
    """Sent back instead of a result: the worker is not what the task needs."""

    is_really: Identity


@dataclass(frozen=True)
class Built:
    """A candidate with its library and verdict, or why it has none."""

    candidate: Candidate
    rejection: Rejection | None


@cache
def _station(scene: str, model: str) -> Station:
    folder = cache_folder()
    compilers = {c.code: c for c in find_compilers()}
    return Station(Workbench(build_bench_tool(folder), folder, compilers), scene, model)


def _with_own_compiler(station: Station, candidate: Candidate) -> Candidate:
    """The candidate as this worker compiles it: by the same version, wherever that lies."""
    own = station.bench.compilers.get(candidate.compiler.code)
    if own is None or own.version != candidate.compiler.version:
        there = own.version if own else "none"
        raise KernelError(
            f"a worker's {candidate.compiler.code} is {there}, not {candidate.compiler.version}"
        )
    return replace(candidate, compiler=own, library=None)


def build_on_worker(task: Task, candidate: Candidate) -> Built | Impostor:
    """Compile and verify. Raises KernelError where the worker has another compiler."""
    if (real := task.identify()) != task.expected:
        return Impostor(real)
    station = _station(task.scene, task.model)
    own = _with_own_compiler(station, candidate)
    rejection = station.compile(own) or station.verify(own)
    return Built(own, rejection)


def time_on_worker(task: Task, job: TimingJob) -> dict[str, Any] | Impostor | KernelError:
    """What carom_bench measured here. Libraries that others built are built here first."""
    if (real := task.identify()) != task.expected:
        return Impostor(real)
    station = _station(task.scene, task.model)
    candidates = tuple(_with_own_compiler(station, c) for c in job.candidates)
    for candidate in candidates:
        rejection = station.compile(candidate)
        if rejection is not None:
            return KernelError(rejection.text)
    try:
        return station.time(replace(job, candidates=candidates))
    except KernelError as error:
        return error  # as a result: an exception may lose its class on the way
