"""A kernel verified and timed, as a row of figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..choice.candidates import baseline, candidates_of
from ..choice.cases import CaseSet
from ..choice.kernel import Emitted, Rejected, Timed, Verified, verdict_of
from ..choice.lookup import with_compiler_found
from ..choice.modelling import frame_bound, lanes_in_flight, loop_report
from ..choice.selection import Selected
from ..choice.timing import job_of, timed_together
from ..choice.workbench import TimingJob, Workbench
from ..evidence.profiling.passes import steps_a_collision
from ..evidence.timing.plan import PlannedKernel
from ..evidence.timing.ratios import TimingResult, timing_results
from ..evidence.verification.errors import Array
from ..targets.target import Target
from ..toolchain.mca import find_mca
from .closed_forms import ClosedRow, closed_forms

COUNTED = 2000  # cases whose steps are counted, of an exact kernel


@dataclass(frozen=True)
class BenchRow:
    """One kernel, verified and timed."""

    candidate: Timed | Rejected
    is_selected: bool
    cases: CaseSet = "mixed"
    bound_cycles: float | None = None  # of a batch kernel: llvm-mca's throughput bound a collision
    core_ghz: float | None = None  # while it was timed
    threads: dict[int, float] | None = None  # ns a collision of a batch shared over threads

    @property
    def rejected(self) -> str:
        """Why the kernel failed; empty where it did not."""
        return self.candidate.text if isinstance(self.candidate, Rejected) else ""

    @property
    def timing(self) -> TimingResult | None:
        """None where it failed."""
        return None if isinstance(self.candidate, Rejected) else self.candidate.timing

    @property
    def error(self) -> float | None:
        """The largest, over the relative speed; None where there is no verdict."""
        verdict = verdict_of(self.candidate)
        return verdict.max_rel_error if verdict else None

    @property
    def steps(self) -> int | None:
        """Fixed steps; None: an exact kernel."""
        return self.candidate.variant.stepper.steps

    def document(self) -> dict[str, Any]:
        """The row as `gen bench --json` writes it."""
        c, v, made = self.candidate, self.candidate.variant, self.candidate.emitted
        timing = self.timing
        return {
            "name": c.name,
            "target": v.target,
            "scene": v.scene,
            "model": v.model,
            "impact": v.question.impact,
            "question": str(v.question),
            "recipe": str(v.recipe),
            "stepper": "euler" if v.stepper.steps else v.stepper.name,
            "steps": v.stepper.steps,
            "budget": v.stepper.budget,
            "width": v.width,
            "compiler": made.compiler.version,
            "flags": " ".join(made.flags),
            "options": dict(v.options),
            "cases": self.cases,
            "ns_per_collision": timing.ns if timing else None,
            "latency_ns": timing.latency_ns if timing else None,
            "tsc_cycles_per_collision": timing.cycles if timing else None,
            "ratio_to_baseline": timing.ratio if timing else None,
            "ratio_ci": list(timing.ratio_ci) if timing else None,
            "max_rel_error": self.error,
            "error_against": f"euler_n{v.stepper.steps}" if v.stepper.steps else "exact",
            "bound_cycles_per_collision": self.bound_cycles,
            "core_ghz": self.core_ghz,
            "ns_by_threads": self.threads,
            "selected": self.is_selected,
            "rejected": self.rejected or None,
        }

    @property
    def baseline_name(self) -> str:
        """What all are timed against."""
        return candidates_of(self.candidate.variant.question.row).baseline

    @property
    def of_bound(self) -> float | None:
        """How many times what its loops' instructions allow a batch kernel takes, if known."""
        timing = self.timing
        if self.bound_cycles is None or not self.core_ghz or timing is None:
            return None
        return timing.ns * self.core_ghz / self.bound_cycles


@dataclass(frozen=True)
class Rows:
    """What was timed together: kernels, and what is none."""

    kernels: tuple[BenchRow, ...]
    closed_forms: tuple[ClosedRow, ...]


def bench_rows(
    tools: Workbench, target: Target, scene: str, entries: Sequence[Selected], seconds: float
) -> Rows:
    """Verify and time the entries and the baseline, model by model, on each set of cases."""
    rows: list[BenchRow] = []
    closed: list[ClosedRow] = []
    for model in dict.fromkeys(entry.model for entry in entries):
        kernels = _checked(tools, target, [e for e in entries if e.model == model])
        for cases in tools.cases.sets:
            bench = _Bench(tools, target, seconds / len(tools.cases.sets), cases)
            found = bench.rows(kernels, tools.cases.timed(scene, model, True, cases))
            told = {row.candidate.name for row in rows if isinstance(row.candidate, Rejected)}
            rows += [row for row in found.kernels if row.candidate.name not in told]
            closed += found.closed_forms
    return Rows(tuple(rows), tuple(closed))


def _checked(
    tools: Workbench, target: Target, entries: Sequence[Selected]
) -> list[Verified | Rejected]:
    """The baseline, then the entries of one model."""
    first = baseline(entries[0].variant.question.contest, list(tools.compilers))
    variants = [first]
    for entry in entries:
        found = with_compiler_found(entry.variant, tools.compilers)  # type: ignore[arg-type]
        variants.append(found)
    emitted = tools.emit_all(variants, target)
    return tools.each("building and verifying", tools.check, emitted)


@dataclass(frozen=True)
class _Bench:
    """The timing of one model's kernels on one set of cases."""

    tools: Workbench
    target: Target
    seconds: float
    cases: CaseSet

    def rows(self, kernels: Sequence[Verified | Rejected], batch: Array) -> Rows:
        """Single calls, then batches beside them; `batch`: the cases of the latter."""
        single = [k for k in kernels if not k.is_batch]
        wide = [k for k in kernels if k.is_batch]
        singles = [BenchRow(k, n > 0, self.cases) for n, k in enumerate(self._timed(single))]
        passed = [k for k in wide if not isinstance(k, Rejected)]
        if not passed:
            failed = (BenchRow(k, True, self.cases) for k in wide if isinstance(k, Rejected))
            return Rows((*singles, *failed), ())
        forms = closed_forms(self.tools, passed[0])
        made = timed_together(
            self.tools.time, self._job([*single, *wide], forms), self.tools.progress
        )
        told, ghz = made.told(wide), made.rounds.whole.core_ghz
        found = {result.name: result for result in timing_results(made.rounds.whole)}
        closed = (ClosedRow(f.name, passed[0], self.cases, found[f.name]) for f in forms)
        rows = (_batch_row(self, k, ghz, batch) for k in told)
        return Rows((*singles, *rows), tuple(closed))

    def _timed(self, single: Sequence[Verified | Rejected]) -> list[Timed | Rejected]:
        """Single calls interleaved with the baseline, the first of them."""
        rejected = [k for k in single if isinstance(k, Rejected)]
        if len(rejected) == len(single):
            return list(rejected)
        job = self._job(single, ())
        return timed_together(self.tools.time, job, self.tools.progress).told(single)

    def _job(
        self, kernels: Sequence[Verified | Rejected], forms: tuple[PlannedKernel, ...]
    ) -> TimingJob:
        return replace(job_of(kernels, self.seconds), cases=self.cases, beside=forms)


def _batch_row(
    bench: _Bench, candidate: Timed | Rejected, ghz: float | None, cases: Array
) -> BenchRow:
    if isinstance(candidate, Rejected):
        return BenchRow(candidate, True, bench.cases)
    tools = bench.tools
    threads = None
    if bench.cases == "mixed":
        threads = tools.tool.threads(candidate.library.path, cases)
    bound = _bound_cycles(tools, candidate, bench.target, cases)
    return BenchRow(candidate, True, bench.cases, bound, ghz, threads)


def _bound_cycles(
    tools: Workbench, candidate: Emitted, target: Target, cases: Array
) -> float | None:
    """Cycles that a collision needs at least in the loops of a batch kernel, all lanes busy.

    Its steps; in an exact kernel also reading, checking and writing it, which the N steps of others
    outweigh. None where there is no such loop, or no llvm-mca.
    """
    variant = candidate.variant
    if find_mca() is None or variant.question.known_scene.closed_form:
        return None
    steps: float | None = variant.stepper.steps
    around = 0.0
    if steps is None:
        cache = tools.cache / "kernels"
        steps = steps_a_collision(variant, candidate.compiler, target, cases[:COUNTED], cache)
        around = frame_bound(tools, candidate, target)
    report = loop_report(tools, candidate, target)
    return report.throughput_bound * steps / lanes_in_flight(variant) + around
