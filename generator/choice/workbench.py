"""From variants to figures: emit, compile, verify, then time or model. Nothing is chosen here."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from generator.emission.kernel_source import KernelSource, emit
from generator.errors import KernelError
from generator.scenes.scene import find_scene
from generator.targets.target import Target
from generator.timing.bench_tool import BenchTool
from generator.timing.plan import PlannedKernel, TimingPlan
from generator.timing.ratios import TimingResult, TimingRun, timing_results
from generator.toolchain.build import BuildJob, BuiltLibrary, build_many
from generator.toolchain.compilers import Compiler, march_flags
from generator.toolchain.flags import compile_flags
from generator.toolchain.mca import McaReport, analyse, assembly_of
from generator.variants.names import name_of, source_name_of
from generator.variants.variant import Variant
from generator.verification.errors import Array
from generator.verification.euler import euler_verdict
from generator.verification.reference import load_reference
from generator.verification.verdict import Verdict

Progress = Callable[[str, int, int], None]  # what, done, of

VERIFY_SEED = 20141
VERIFY_RANDOM = 2000
TIMING_SEED = 7735
TIMING_CASES = 4096


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
    timing: TimingResult | None = None
    mca: McaReport | None = None
    rejected: str = ""

    @property
    def name(self) -> str:
        return name_of(self.variant)

    @property
    def sources(self) -> dict[str, str]:
        return {
            "carom.h": self.source.header,
            "kernel.cpp": self.source.source,
            "probe.cpp": self.source.probe,
        }


@dataclass(frozen=True)
class Expected:
    """Cases and what must come out of them, for one scene and model."""

    cases: Array
    exact: Array
    euler: Array | None
    reference_rows: int  # how many of them are the committed reference
    seed: int


@dataclass
class Workbench:
    """The tools and the cache that a job uses."""

    tool: BenchTool
    cache: Path
    compilers: dict[str, Compiler]
    progress: Progress = field(default=lambda what, done, of: None)

    # -- emit and compile --

    def prepare(self, variants: Sequence[Variant], target: Target) -> list[Candidate]:
        """Emit every variant once; variants that differ only in compiler or flags share a text."""
        texts: dict[str, KernelSource] = {}
        candidates = []
        for index, variant in enumerate(variants):
            self.progress("deriving and emitting", index, len(variants))
            key = source_name_of(variant)
            if key not in texts:
                texts[key] = emit(variant)
            compiler = self.compilers[variant["compiler"]]
            flags = compile_flags(variant, compiler, target)
            note = march_flags(compiler, target).note
            candidates.append(Candidate(variant, texts[key], compiler, flags, note))
        self.progress("deriving and emitting", len(variants), len(variants))
        return candidates

    def compile(self, candidates: Sequence[Candidate]) -> None:
        """Build libraries in parallel; a failure rejects its candidate."""
        jobs = [BuildJob(c.name, c.sources, c.compiler, c.flags) for c in candidates]
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

    # -- verify --

    def expected(
        self, scene: str, model: str, steps: int | None, seed: int, random: int
    ) -> Expected:
        """The reference (where the scene fixes nothing) and random cases with their answers."""
        fixed = {str(k): v for k, v in find_scene(scene).fixed.items()}
        self.progress("computing expected results", 0, 1)
        cases = self.tool.make_cases(seed, random, mixed=False, fixed=fixed).rows
        reference_rows = 0
        if not fixed:
            reference = load_reference().cases
            reference_rows = len(reference)
            cases = np.vstack([reference, cases])
        exact = self.tool.expect(cases, "exact", model)
        euler = None if steps is None else self.tool.expect(cases, "euler", model, steps)
        self.progress("computing expected results", 1, 1)
        return Expected(cases, exact, euler, reference_rows, seed)

    def verify(self, candidates: Sequence[Candidate], expected: Expected) -> None:
        """Verdict for each built candidate; what fails is rejected with the reason."""
        alive = [c for c in candidates if c.library is not None and not c.rejected]
        for index, candidate in enumerate(alive):
            self.progress("verifying", index, len(alive))
            candidate.verdict = self._verdict(candidate, expected)
            if not candidate.verdict.passed:
                candidate.rejected = f"verification: {candidate.verdict.reason}"
        self.progress("verifying", len(alive), len(alive))

    def _verdict(self, candidate: Candidate, expected: Expected) -> Verdict:
        assert candidate.library is not None
        try:
            got = self.tool.run_kernel(candidate.library.path, expected.cases, timeout=300.0)
        except KernelError as error:
            return Verdict(False, str(error), float("nan"), float("nan"), len(expected.cases))
        steps = candidate.variant.stepper.steps
        assert steps is not None and expected.euler is not None
        return euler_verdict(expected.cases, got, expected.euler, expected.exact, steps)

    # -- time, or model --

    def time(
        self, candidates: Sequence[Candidate], baseline: Candidate, scene: str, seconds: float
    ) -> TimingRun:
        """Time what passed, interleaved with the baseline, in one process."""
        alive = [c for c in candidates if c.verdict is not None and c.verdict.passed]
        fixed = {str(k): v for k, v in find_scene(scene).fixed.items()}
        cases = self.tool.make_cases(TIMING_SEED, TIMING_CASES, fixed=fixed).rows
        reference = load_reference()
        seeds = None if fixed else reference.cases[reference.rows_of("seed_case")]
        kernels = tuple(
            PlannedKernel(c.name, c.library.path, latency=True)
            for c in _unique([baseline, *alive])
            if c.library is not None
        )
        self.progress(f"timing {len(kernels)} kernels for {seconds:.0f} s", 0, 1)
        run = self.tool.time(
            TimingPlan(cases, kernels, baseline.name, seeds, rounds=1000, seconds=seconds)
        )
        results = {result.name: result for result in timing_results(run)}
        for candidate in candidates:
            candidate.timing = results.get(candidate.name)
        baseline.timing = results[baseline.name]
        self.progress("timing", 1, 1)
        return run

    def model(self, candidates: Sequence[Candidate], target: Target) -> None:
        """llvm-mca's figures for the loop of each candidate on the target."""
        alive = [c for c in candidates if not c.rejected]
        for index, candidate in enumerate(alive):
            self.progress(f"modelling on {target.row.mca_cpu} (llvm-mca)", index, len(alive))
            try:
                text = assembly_of(
                    {k: v for k, v in candidate.sources.items() if k != "probe.cpp"},
                    (),
                    candidate.compiler,
                    candidate.flags,
                    candidate.name,
                )
                candidate.mca = analyse(text, target)
            except KernelError as error:
                candidate.rejected = f"llvm-mca: {error}"
        self.progress("modelling", len(alive), len(alive))


def _unique(candidates: Sequence[Candidate]) -> list[Candidate]:
    seen: dict[str, Candidate] = {}
    for candidate in candidates:
        seen.setdefault(candidate.name, candidate)
    return list(seen.values())
