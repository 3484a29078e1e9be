"""From variants to figures: emit, build, verify, time. Whoever needs a kernel gets it here.

Nothing is chosen here. A step gives the next stage of a kernel (`choice.kernel`) or `Rejected`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TypeVar

from filelock import FileLock

from ..emission.kernel_source import KernelSource, emit
from ..errors import KernelError
from ..evidence.records.code import key_of
from ..evidence.records.evidence import Timings
from ..evidence.timing.bench_tool import BenchTool
from ..evidence.timing.emulated import EmulatedRunner
from ..evidence.timing.plan import PlannedKernel, TimingPlan
from ..evidence.verification.reference import load_reference
from ..lowering.isa import estimates_in
from ..registry.names import source_name_of
from ..registry.question import Contest
from ..registry.roots import is_reproducible
from ..registry.variant import Variant
from ..targets.target import Target
from ..toolchain.build import build
from ..toolchain.compilers import Compiler, march_flags
from ..toolchain.flags import compile_flags
from .cases import EMULATED, Cases, CaseSet, Progress
from .kernel import Built, Emitted, Rejected, Verified
from .store import Store
from .trials import Rules
from .verifier import Verifier, verification_hash

_TEXTS = 256  # that are kept in memory
BLOCK_MS = 1.0  # of each kernel in each round
Given = TypeVar("Given", bound=Emitted)
Item = TypeVar("Item")
Made = TypeVar("Made")


@dataclass(frozen=True)
class TimingJob:
    """Kernels to be timed together, the baseline first, for `rounds` or at most `seconds`.

    Where one of them has lanes, all are timed on cases that share their parameters: those with
    lanes by their batch function, the others call by call. `latency`: single calls also each fed
    by the last, and on the seed cases. `beside`: what is timed with them and is no kernel.
    """

    kernels: tuple[Built, ...]
    rounds: int
    seconds: float
    latency: bool = False
    cases: CaseSet = "mixed"
    beside: tuple[PlannedKernel, ...] = ()

    @property
    def batches(self) -> bool:
        return any(kernel.is_batch for kernel in self.kernels)

    @property
    def fed(self) -> bool:
        """Are single calls also fed by the last?"""
        return self.latency and not self.batches and self.cases == "mixed"

    @property
    def baseline(self) -> Built:
        return self.kernels[0]


@dataclass
class Workbench:
    """The tools and the cache that a job uses."""

    tool: BenchTool
    cache: Path
    compilers: dict[str, Compiler]
    progress: Progress = field(default=lambda what, done, of: None)
    fresh: bool = False  # verify and time anew instead of reusing what is still valid
    emulated: EmulatedRunner | None = None  # runs kernels of another architecture
    timings: Timings = field(default_factory=Timings)  # of CPUs that are not here
    reproducible: bool = False  # choose only what gives the same bits on every CPU

    def __post_init__(self) -> None:
        self.store = Store(self.cache / "figures", self.fresh)
        every = EMULATED if self.emulated is not None else 1
        self.cases = Cases(self.tool, self.store, self.progress, every)
        self.verifier = Verifier(self.tool, self.cache, self.cases, self.emulated)
        self._texts: dict[str, KernelSource] = {}  # by source name

    # -- one kernel --

    def emit(self, variant: Variant, target: Target) -> Emitted:
        """Variants that differ only in compiler or flags share a text."""
        key = source_name_of(variant)
        if key not in self._texts:
            if len(self._texts) >= _TEXTS:
                del self._texts[next(iter(self._texts))]
            self._texts[key] = emit(variant)
        compiler = self.compilers[variant["compiler"]]
        return Emitted(
            variant=variant,
            source=self._texts[key],
            compiler=compiler,
            flags=compile_flags(variant, compiler, target),
            march_note=march_flags(compiler, target).note,
        )

    def build(self, kernel: Emitted) -> Built | Rejected:
        try:
            library = build(kernel.build_job, self.cache / "kernels")
        except KernelError as error:
            return Rejected(kernel, "compile", f"compile: {error}")
        self.store.count("builds", library.hit)
        return kernel.built(library)

    def built(self, variant: Variant, target: Target) -> Built:
        """Emitted and built. Raises KernelError where it cannot be."""
        made = self.build(self.emit(variant, target))
        if isinstance(made, Rejected):
            raise KernelError(made.text)
        return made

    def check(self, kernel: Emitted) -> Verified | Rejected:
        """Build and verify, also under the worst root estimates."""
        made: Built | Rejected = self.build(kernel)
        if isinstance(made, Built):
            made = self.verify(made)
        return self.verifier.verify_at_worst(made) if isinstance(made, Verified) else made

    def verify(self, kernel: Built) -> Verified | Rejected:
        """As the verifier does, where it may be chosen at all."""
        if self.reproducible and _shaky(kernel):
            return Rejected(kernel, "reproducible", "its bits depend on the CPU or on the compiler")
        return self.verifier.verify(kernel)

    # -- many, side by side; what was rejected before stays as it is --

    def emit_all(self, variants: Sequence[Variant], target: Target) -> list[Emitted]:
        found = []
        for index, variant in enumerate(variants):
            self.progress("deriving and emitting", index, len(variants))
            found.append(self.emit(variant, target))
        self.progress("deriving and emitting", len(variants), len(variants))
        return found

    def build_all(self, kernels: Sequence[Emitted | Rejected]) -> list[Built | Rejected]:
        return self.each("compiling", self.build, kernels)

    def verify_all(self, kernels: Sequence[Built | Rejected]) -> list[Verified | Rejected]:
        for kernel in kernels:  # made once, not by each thread
            self.cases.of(kernel.variant)
        return self.each("verifying", self.verify, kernels)

    def each(
        self,
        what: str,
        work: Callable[[Given], Made],
        kernels: Sequence[Given | Rejected],
    ) -> list[Made | Rejected]:
        """Work on each that was not rejected, side by side, with progress; in their order."""
        alive = {n: k for n, k in enumerate(kernels) if not isinstance(k, Rejected)}
        made: dict[int, Made | Rejected] = {
            n: k for n, k in enumerate(kernels) if isinstance(k, Rejected)
        }
        self.progress(what, 0, len(alive))
        numbered = side_by_side(lambda n: work(alive[n]), list(alive))
        for done, (number, result) in enumerate(numbered, 1):
            made[number] = result
            self.progress(what, done, len(alive))
        return [made[n] for n in range(len(kernels))]

    # -- time --

    def rules(self, contest: Contest, cpu: str) -> Rules:
        """What the figures of a contest that a CPU times depend on besides the kernel."""
        head = (contest.scene, contest.model)
        expected = self.cases.expected(*head, contest.goal.steps)
        timed = self.cases.timed(*head, contest.batches)
        return Rules(
            cpu=cpu,
            call=contest.call,
            cases=key_of(timed, timed.shape[1]),
            answers=expected.key,
            rules=verification_hash(self.tool.impact.folder),
            bench=self.tool.timing,
        )

    def plan(self, job: TimingJob) -> TimingPlan:
        """A job as carom_bench takes it."""
        asked, batches = job.kernels[-1].variant.question, job.batches
        kernels = tuple(
            PlannedKernel(
                kernel.name,
                kernel.library.path,
                batch=kernel.is_batch,
                latency=job.fed,
            )
            for kernel in {kernel.name: kernel for kernel in job.kernels}.values()
        )
        seeds = None
        if job.fed and asked.known_scene.unrestricted:
            evidence = self.cases.evidence
            reference = load_reference(evidence.reference)
            seeds = reference.cases[reference.rows_of(evidence.seeds)]
        return TimingPlan(
            self.cases.timed(asked.scene, job.baseline.variant.model, batches, job.cases),
            (*kernels, *job.beside),
            job.baseline.name,
            seeds,
            rounds=job.rounds,
            seconds=job.seconds,
            block_ms=BLOCK_MS,
        )

    def time(self, job: TimingJob) -> dict[str, Any]:
        """What carom_bench measured, and the day; no other timing of this cache runs meanwhile.

        Raises KernelCrash or KernelTimeout where a kernel ends the process.
        """
        plan = self.plan(job)
        with FileLock(self.cache / "timing.lock"):
            document = self.tool.timing_document(plan)
        return {**document, "day": datetime.now(UTC).date().isoformat()}


def side_by_side(
    work: Callable[[Item], Made], items: Sequence[Item], workers: int | None = None
) -> Iterator[tuple[Item, Made]]:
    """Each item with its result as it is done; an interruption drops what has not begun."""
    pool = ThreadPoolExecutor(workers or os.cpu_count() or 1)
    try:
        futures = {pool.submit(work, item): item for item in items}
        for future in as_completed(futures):
            yield futures[future], future.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _shaky(kernel: Emitted) -> bool:
    """May it differ between CPUs? The report's rows are only compared with."""
    shaky = estimates_in(kernel.source.source) or not is_reproducible(kernel.variant)
    return bool(shaky) and kernel.variant["flags"] == "strict"
