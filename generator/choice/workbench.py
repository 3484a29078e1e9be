"""From variants to figures: emit, compile, verify, then time. Nothing is chosen here."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from ..emission.kernel_source import KernelSource, emit
from ..errors import KernelError
from ..evidence.records.evidence import Found, Timings
from ..evidence.timing.bench_tool import BenchTool, Method
from ..evidence.timing.emulated import EmulatedRunner
from ..evidence.timing.plan import PlannedKernel, TimingPlan
from ..evidence.timing.ratios import TimingResult, TimingRun, timing_results, timing_run
from ..evidence.verification.errors import EXPECTED_COLUMNS, Array
from ..evidence.verification.floors import rounding_of
from ..evidence.verification.hard_cases import (
    NEIGHBOURS,
    load_hard,
    moved_by,
    neighbours,
)
from ..evidence.verification.reference import EULER_STEPS, load_reference
from ..evidence.verification.scene_cases import cases_for_scene
from ..evidence.verification.verdict import Verdict, with_worst
from ..evidence.verification.worst_estimates import PATTERNS, at_worst
from ..impacts.ball_ball.scene import Scene, find_scene
from ..lowering.isa import estimates_in
from ..registry.names import name_of, source_name_of
from ..registry.roots import is_reproducible
from ..registry.variant import Variant
from ..targets.host import read_host
from ..targets.target import Target
from ..toolchain.build import BuildJob, BuiltLibrary, build, build_many, cache_key
from ..toolchain.compilers import Compiler, march_flags
from ..toolchain.flags import compile_flags
from ..toolchain.mca import with_regions
from ..toolchain.replay import Modelled
from .store import Store, key_of
from .verifying import (
    Expected,
    HardCases,
    Run,
    broken,
    verdict_of,
    verdicts,
    worst_verdict,
)

Progress = Callable[[str, int, int], None]  # what, done, of

VERIFY_SEED = 20141
VERIFY_RANDOM = 5000
TIMING_SEED = 7735
TIMING_CASES = 4096
_TEXTS = 256  # that are kept in memory
# A batch has one R, M, u_s and e_b: those of a pool table.
BATCH_PARAMETERS = {"R": 0.028575, "M": 0.170097, "u_s1": 0.2, "u_s2": 0.2, "e_b": 0.95}


@dataclass
class Candidate:
    """A variant on its way; what is not known yet is None, `rejected` says why it ended."""

    variant: Variant
    source: KernelSource
    compiler: Compiler
    flags: tuple[str, ...]
    march_note: str = ""
    library: BuiltLibrary | None = None
    verdict: Verdict | None = None
    pooltool: Verdict | None = None  # against pooltool's own doubles, where they exist
    timing: TimingResult | None = None
    modelled: Modelled | None = None  # where the target's CPU is not here
    recorded: Found | None = None  # likewise: what was timed on such a CPU
    rejected: str = ""

    @property
    def name(self) -> str:
        return name_of(self.variant)

    @property
    def is_batch(self) -> bool:
        """Lanes are filled from a batch; what has one lane is called for one collision."""
        return self.variant.width > 1

    @property
    def build_job(self) -> BuildJob:
        return BuildJob(self.name, self.sources, self.compiler, self.flags)

    @property
    def sources(self) -> dict[str, str]:
        return {
            "carom.h": self.source.header,
            "kernel.cpp": self.source.source,
            "probe.cpp": self.source.probe,
        }

    @property
    def with_regions(self) -> dict[str, str]:
        """The kernel alone, with the regions that llvm-mca knows."""
        return {"carom.h": self.source.header, "kernel.cpp": with_regions(self.source.marked)}


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
    kernel_timeout: float = 300.0  # seconds for a kernel over the cases that are verified on

    def __post_init__(self) -> None:
        self.store = Store(self.cache / "figures", self.fresh)
        self.labels: tuple[str, ...] = ()  # of the cases that are verified on
        self._texts: dict[str, KernelSource] = {}  # by source name

    def reused(self) -> str:
        """What was taken from earlier runs; empty where nothing was."""
        return self.store.counts()

    # -- emit and compile --

    def prepare(self, variants: Sequence[Variant], target: Target) -> list[Candidate]:
        """Emit every variant once; variants that differ only in compiler or flags share a text."""
        candidates = []
        for index, variant in enumerate(variants):
            self.progress("deriving and emitting", index, len(variants))
            key = source_name_of(variant)
            if key not in self._texts:
                if len(self._texts) >= _TEXTS:
                    del self._texts[next(iter(self._texts))]
                self._texts[key] = emit(variant)
            compiler = self.compilers[variant["compiler"]]
            flags = compile_flags(variant, compiler, target)
            note = march_flags(compiler, target).note
            candidates.append(Candidate(variant, self._texts[key], compiler, flags, note))
        self.progress("deriving and emitting", len(variants), len(variants))
        return candidates

    def compile(self, candidates: Sequence[Candidate]) -> None:
        """Build libraries in parallel; a failure rejects its candidate."""
        jobs = [c.build_job for c in candidates]
        done = 0

        def tick(job: BuildJob, _result: object) -> None:
            nonlocal done
            done += 1
            self.progress(f"compiling ({job.compiler.code})", done, len(jobs))

        results = build_many(jobs, self.cache / "kernels", on_done=tick)
        for candidate, result in zip(candidates, results, strict=True):
            if isinstance(result, KernelError):
                candidate.rejected = f"compile: {result}"
            else:
                candidate.library = result
                self.store.count("builds", result.hit)

    # -- verify --

    def expected(
        self, scene: str, model: str, steps: int | None, seed: int, random: int
    ) -> Expected:
        """The reference, random and kept hard cases, adapted to the scene, with their answers."""
        known = find_scene(scene)
        self.progress("computing expected results", 0, 1)
        made = self.tool.make_cases(seed, random, mixed=False)
        reference, pooltool, reference_rows = load_reference(), None, 0
        cases = cases_for_scene(known, np.vstack([reference.cases, made.rows]), model)
        hard = self._hard(known, model)
        named = zip(reference.ids, reference.kinds, strict=True)
        adapted = "reference" if known.unrestricted else "adapted"
        labels = (
            *(f"{adapted} {i} ({kind})" for i, kind in named),
            *(f"random {i} ({kind})" for i, kind in enumerate(made.kinds)),
            *(f"hard {i} ({kind})" for i, kind in enumerate(load_hard()[0])),
        )
        if known.unrestricted:
            reference_rows = len(reference.cases)
            if model == "pooltool" and steps == EULER_STEPS:
                pooltool = reference.euler_pooltool
        exact = self._oracle(cases, "exact", model, 0, known.oracle_options)
        euler = None
        if steps is not None and known.fixed_steps:
            euler = self._oracle(cases, "euler", model, steps)
        self.progress("computing expected results", 1, 1)
        self.labels = labels
        every = (cases, exact, euler, pooltool, hard.cases, hard.exact, hard.steep)
        return Expected(
            scene=scene,
            cases=cases,
            exact=exact,
            euler=euler,
            reference_rows=reference_rows,
            seed=seed,
            labels=labels,
            pooltool=pooltool,
            key=key_of(*(t if t is not None else "none" for t in every)),
            hard=hard,
        )

    def _hard(self, scene: Scene, model: str) -> HardCases:
        """The kept hard cases in a scene, each with its neighbours asked for too."""
        cases = cases_for_scene(scene, load_hard()[1], model)
        rows = neighbours(cases)
        exact = self._oracle(rows, "exact", model, 0, scene.oracle_options)
        steep = np.maximum(moved_by(rows, exact), rounding_of(cases))
        return HardCases(cases, exact[::NEIGHBOURS], steep)

    def _oracle(
        self, cases: Array, method: Method, model: str, steps: int, more: tuple[str, ...] = ()
    ) -> Array:
        key = key_of(self.tool.executable.name, cases, method, model, steps, more)
        return self.store.kept_array(
            "expected results",
            key,
            EXPECTED_COLUMNS,
            lambda: self.tool.expect(cases, method, model, steps or EULER_STEPS, more),
        )

    def verify(self, candidates: Sequence[Candidate], expected: Expected) -> None:
        """Verdict for each built candidate; what fails is rejected with the reason.

        A baseline of another scene is none of these cases' and gets no verdict.
        """
        alive = [c for c in candidates if c.library is not None and not c.rejected]
        alive = [c for c in alive if c.variant.scene == expected.scene]
        if self.reproducible:
            for candidate in alive:
                _require_reproducible(candidate)
            alive = [c for c in alive if not c.rejected]
        for index, candidate in enumerate(alive):
            self.progress("verifying", index, len(alive))
            self._verify_one(candidate, expected)
        self.progress("verifying", len(alive), len(alive))

    def verify_at_worst(self, candidates: Sequence[Candidate], expected: Expected) -> None:
        """What `verify` passed, where it estimates roots, under the worst estimates allowed."""
        alive = [c for c in candidates if c.verdict is not None and not c.rejected]
        shaky = [c for c in alive if estimates_in(c.source.source)]
        if not shaky:
            return
        what = "verifying under the worst root estimates"
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            verdicts = pool.map(lambda c: self._worst_verdict(c, expected), shaky)
            for index, (candidate, worst) in enumerate(zip(shaky, verdicts, strict=True)):
                self.progress(what, index, len(shaky))
                assert candidate.verdict is not None
                candidate.verdict = with_worst(candidate.verdict, worst)
                if not worst.passed:
                    candidate.rejected = f"verification: {worst.reason}"
        self.progress(what, len(shaky), len(shaky))

    def _verify_one(self, candidate: Candidate, expected: Expected) -> None:
        assert candidate.library is not None
        key = key_of(
            candidate.library.key,
            expected.key,
            verification_hash(),
            str(candidate.variant.stepper.goal),
            self.kernel_timeout,
        )
        library = candidate.library.path
        kept = self.store.kept(
            "verdicts",
            key,
            lambda: verdicts(self._runner(library), candidate.variant, expected),
        )
        candidate.verdict = verdict_of(kept["oracle"])
        against = "verification"
        if kept["pooltool"] is not None:
            candidate.pooltool = verdict_of(kept["pooltool"])
        verdict = candidate.verdict
        if verdict.passed and candidate.pooltool is not None and not candidate.pooltool.passed:
            verdict, against = candidate.pooltool, "verification against euler_n1000.csv"
        if not verdict.passed:
            candidate.rejected = f"{against}: {verdict.reason}"

    def _worst_verdict(self, candidate: Candidate, expected: Expected) -> Verdict:
        """From the store, or made now."""
        job, variant = at_worst(candidate.build_job), candidate.variant
        patterns = [asdict(pattern) for pattern in PATTERNS]
        rules = verification_hash(), str(variant.stepper.goal), self.kernel_timeout
        key = key_of(cache_key(job), expected.key, *rules, patterns)

        def make() -> dict[str, Any]:
            try:
                library = build(job, self.cache / "kernels").path
            except KernelError as error:
                return broken(error, expected)
            under = partial(self._runner, library)
            return worst_verdict(under, variant, expected)

        return verdict_of(self.store.kept("verdicts under worst estimates", key, make))

    def _runner(self, library: Path, environment: Mapping[str, str] | None = None) -> Run:
        """Runs cases through a library, one by one or as a batch."""

        def run(cases: Array, batch: bool) -> Array:
            limit = self.kernel_timeout
            if self.emulated is not None:
                return self.emulated.run_kernel(library, cases, batch=batch, timeout=limit)
            return self.tool.run_kernel(
                library, cases, batch=batch, timeout=limit, environment=environment
            )

        return run

    # -- time --

    def timing_cases(self, scene: str, model: str) -> Array:
        """The random cases that kernels are timed on, adapted to the scene."""
        made = self.tool.make_cases(TIMING_SEED, TIMING_CASES).rows
        return cases_for_scene(find_scene(scene), made, model)

    def batch_cases(self, scene: str, model: str) -> Array:
        """As timing_cases, with the same parameters for all but u_b: what a batch can take."""
        made = self.tool.make_cases(TIMING_SEED, TIMING_CASES, fixed=BATCH_PARAMETERS).rows
        return cases_for_scene(find_scene(scene), made, model)

    def time(
        self,
        candidates: Sequence[Candidate],
        baseline: Candidate,
        scene: str,
        seconds: float,
        batches: bool = False,
    ) -> TimingRun:
        """Time what passed, interleaved with the baseline, in one process.

        `batches`: on cases that share their parameters; kernels of several lanes by their batch
        function, all others call by call.
        """
        alive = [c for c in candidates if c.verdict is not None and not c.rejected]
        if not alive:
            reasons = sorted({c.rejected for c in candidates if c.rejected})
            raise KernelError(f"no candidate passed verification: {'; '.join(reasons[:3])}")
        known = find_scene(scene)
        model = baseline.variant.model
        cases = self.batch_cases(scene, model) if batches else self.timing_cases(scene, model)
        reference = load_reference()
        seed_cases = reference.cases[reference.rows_of("seed_case")]
        seeds = seed_cases if known.unrestricted and not batches else None
        kernels = tuple(
            PlannedKernel(
                c.name, c.library.path, batch=c.is_batch, latency=not (batches or c.is_batch)
            )
            for c in _unique([baseline, *alive])
            if c.library is not None
        )
        self.progress(f"timing {len(kernels)} kernels for {seconds:.0f} s", 0, 1)
        plan = TimingPlan(cases, kernels, baseline.name, seeds, rounds=1000, seconds=seconds)
        libraries = {c.name: c.library.key for c in [baseline, *alive] if c.library is not None}
        host = read_host()
        key = key_of(libraries, baseline.name, cases, self.tool.executable.name, host.cpu, seconds)
        day = datetime.now(UTC).date().isoformat()
        made = self.store.kept(
            "timings", key, lambda: {**self.tool.timing_document(plan), "day": day}
        )
        run = timing_run(made)
        results = {result.name: result for result in timing_results(run)}
        for candidate in candidates:
            candidate.timing = results.get(candidate.name)
        baseline.timing = results[baseline.name]
        self.progress("timing", 1, 1)
        return run


def _require_reproducible(candidate: Candidate) -> None:
    """Reject what may differ between CPUs; the report's rows are only compared with."""
    shaky = estimates_in(candidate.source.source) or not is_reproducible(candidate.variant)
    if shaky and candidate.variant["flags"] == "strict":
        candidate.rejected = "its bits depend on the CPU or on the compiler"


@cache
def verification_hash() -> str:
    """Hash of the rules of verification: a verdict holds only under the rules it was given by."""
    folder = Path(__file__).parents[1] / "evidence" / "verification"
    return key_of(*(path.read_text("utf-8") for path in sorted(folder.glob("*.py"))))


def _unique(candidates: Sequence[Candidate]) -> list[Candidate]:
    seen: dict[str, Candidate] = {}
    for candidate in candidates:
        seen.setdefault(candidate.name, candidate)
    return list(seen.values())
