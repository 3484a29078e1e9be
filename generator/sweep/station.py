"""One machine that works for a sweep: it compiles, verifies and times what it is given."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from filelock import FileLock

from ..choice.store import key_of
from ..choice.verifying import Expected
from ..choice.workbench import (
    VERIFY_RANDOM,
    VERIFY_SEED,
    Candidate,
    Workbench,
    verification_hash,
)
from ..errors import EmissionError, KernelCrash, KernelError, KernelTimeout
from ..evidence.records.code import source_hash
from ..evidence.timing.plan import Array, PlannedKernel, TimingPlan
from ..files import write_file
from ..registry.names import name_of, source_name_of
from ..registry.variant import Variant
from ..targets.host import Host, read_host
from ..targets.target import Target
from ..toolchain.flags import compile_flags
from .record import Rejection
from .sources import emission_hash

BASELINE_STEPS = 1000
KERNEL_TIMEOUT = 30.0  # seconds for a kernel over all cases; the slowest take half a second
BLOCK_MS = 1.0


@dataclass(frozen=True)
class Rules:
    """What a station's figures depend on besides the kernel: two with the same may be compared."""

    cases: str
    rules: str
    bench: str
    timed: str = ""  # of the cases, those that are timed on


@dataclass(frozen=True)
class Code:
    """What the compiler is given: hash of the text without its name, version and flags."""

    source: str
    compiler: str
    flags: tuple[str, ...]


@dataclass(frozen=True)
class TimingJob:
    """Kernels to be timed together, the baseline first."""

    candidates: tuple[Candidate, ...]
    rounds: int
    seconds: float  # at most

    @property
    def batches(self) -> bool:
        return any(candidate.is_batch for candidate in self.candidates)

    @property
    def baseline(self) -> Candidate:
        return self.candidates[0]


@dataclass
class Station:
    """A workbench with the cases of one scene and model."""

    bench: Workbench
    scene: str
    model: str
    _expected: dict[int | None, Expected] = field(default_factory=dict)
    _timing_cases: dict[bool, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.bench.kernel_timeout = KERNEL_TIMEOUT

    def host(self) -> Host:
        return read_host()

    def expected(self, steps: int | None) -> Expected:
        """Cases with what must come out, for a number of fixed steps or for exact kernels."""
        if steps not in self._expected:
            made = self.bench.expected(self.scene, self.model, steps, VERIFY_SEED, VERIFY_RANDOM)
            self._expected[steps] = made
        return self._expected[steps]

    def timing_cases(self, batches: bool) -> Array:
        """What kernels are timed on; a batch has one set of parameters for all but u_b."""
        if batches not in self._timing_cases:
            make = self.bench.batch_cases if batches else self.bench.timing_cases
            self._timing_cases[batches] = make(self.scene, self.model)
        return self._timing_cases[batches]

    def rules(self, steps: int | None, batches: bool) -> Rules:
        timed = self.timing_cases(batches)
        cases = key_of(self.expected(steps).key, timed, timed.shape[1])
        tool = self.bench.tool.executable.name
        return Rules(cases, verification_hash(), tool, key_of(timed, timed.shape[1]))

    def emit(self, variant: Variant, target: Target) -> Candidate:
        """The candidate of a variant. EmissionError says what is wrong, whatever it is."""
        try:
            [candidate] = self.bench.prepare([variant], target)
        except Exception as error:  # a bug in laying one out must not end a sweep of thousands
            what = f"{type(error).__name__}: {error}"
            raise EmissionError(f"{name_of(variant)}: emission: {what}") from error
        return candidate

    def code(self, variant: Variant, target: Target) -> Code:
        """Without emitting it where an earlier run did, by the same sources of the generator."""
        key = key_of(source_name_of(variant), emission_hash())
        made = self.bench.store.kept(
            "hashes of texts", key, lambda: source_hash(self.emit(variant, target).source)
        )
        compiler = self.bench.compilers[variant["compiler"]]
        return Code(made, compiler.version, compile_flags(variant, compiler, target))

    def compile(self, candidate: Candidate) -> Rejection | None:
        """Give a candidate its library, or say why there is none."""
        self.bench.compile([candidate])
        if candidate.library is not None:
            return None
        return Rejection(reason="compile", text=one_line(candidate.rejected))

    def verify(self, candidate: Candidate) -> Rejection | None:
        """Give a candidate that has a library its verdict."""
        expected = self.expected(candidate.variant.stepper.steps)
        self.bench.verify([candidate], expected)
        self.bench.verify_at_worst([candidate], expected)
        if not candidate.rejected:
            return None
        assert candidate.verdict is not None
        reason = candidate.verdict.ended or "wrong result"
        return Rejection(reason=reason, text=one_line(candidate.rejected))

    def time(self, job: TimingJob) -> dict[str, Any]:
        """What carom_bench measured; no other timing runs on this machine's cache meanwhile.

        Raises KernelCrash or KernelTimeout where a kernel ends the process.
        """
        planned = []
        for candidate in job.candidates:
            assert candidate.library is not None
            path = candidate.library.path
            planned.append(PlannedKernel(candidate.name, path, batch=candidate.is_batch))
        plan = TimingPlan(
            self.timing_cases(job.batches),
            tuple(planned),
            job.baseline.name,
            rounds=job.rounds,
            seconds=job.seconds,
            block_ms=BLOCK_MS,
        )
        with FileLock(self.bench.cache / "timing.lock"):
            return self.bench.tool.timing_document(plan)


def rejection_of(error: KernelError) -> Rejection:
    """Why a kernel was not timed to the end."""
    reason = "timeout" if isinstance(error, KernelTimeout) else "crash"
    if not isinstance(error, KernelCrash | KernelTimeout):
        reason = "wrong result"  # the bench refused what it gave
    return Rejection(reason=reason, text=one_line(f"timing: {error}"))  # type: ignore[arg-type]


def one_line(text: str) -> str:
    return " ".join(text.split())


def installed(cache: Path, key: str, content: bytes) -> Path:
    """A library that was built on another machine, in this one's cache."""
    path = cache / "received" / key / "kernel.so"
    if not path.is_file():
        write_file(path, content, parents=True)
    return path
