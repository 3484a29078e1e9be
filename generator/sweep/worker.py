"""What a worker of a cluster does for a sweep. It has a clone of its own, with its own cache."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from ..choice.kernel import Emitted, Rejected, Verified
from ..choice.verifier import verification_hash
from ..choice.workbench import TimingJob, Workbench
from ..errors import KernelError
from ..evidence.timing.bench_tool import build_bench_tool, source_hash
from ..impacts.registry import DEFAULT, find_impact
from ..places import cache_folder
from ..targets.host import read_host
from ..toolchain.compilers import find_compilers
from .lab import Lab


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
    impact = find_impact(DEFAULT)
    bench = source_hash(impact)
    return Identity(host.target.name, host.exact, host.cpu, verification_hash(impact.folder), bench)


@dataclass(frozen=True)
class Task:
    """What a job is sent with. A worker that turns out not to be `expected` does not do it."""

    expected: Identity
    identify: Callable[[], Identity]


@dataclass(frozen=True)
class Impostor:
    """Sent back instead of a result: the worker is not what the task needs."""

    is_really: Identity


@cache
def _lab() -> Lab:
    folder = cache_folder()
    compilers = {c.code: c for c in find_compilers()}
    return Lab(Workbench(build_bench_tool(folder), folder, compilers), read_host().target)


def _with_own_compiler(lab: Lab, kernel: Emitted) -> Emitted:
    """The kernel as this worker compiles it: by the same version, wherever that lies."""
    own = lab.bench.compilers.get(kernel.compiler.code)
    if own is None or own.version != kernel.compiler.version:
        there = own.version if own else "none"
        raise KernelError(
            f"a worker's {kernel.compiler.code} is {there}, not {kernel.compiler.version}"
        )
    return replace(kernel, compiler=own)


def build_on_worker(task: Task, kernel: Emitted) -> Verified | Rejected | Impostor:
    """Build and verify. Raises KernelError where the worker has another compiler."""
    if (real := task.identify()) != task.expected:
        return Impostor(real)
    lab = _lab()
    return lab.bench.check(_with_own_compiler(lab, kernel))


def time_on_worker(task: Task, job: TimingJob) -> dict[str, Any] | Impostor | KernelError:
    """What carom_bench measured here. Libraries that others built are built here first."""
    if (real := task.identify()) != task.expected:
        return Impostor(real)
    lab, kernels = _lab(), []
    for kernel in job.kernels:
        built = lab.bench.build(_with_own_compiler(lab, kernel))
        if isinstance(built, Rejected):
            return KernelError(built.text)
        kernels.append(built)
    try:
        return lab.time(replace(job, kernels=tuple(kernels)))
    except KernelError as error:
        return error  # as a result: an exception may lose its class on the way
