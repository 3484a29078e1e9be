"""A kernel verified and timed, as a row of figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..choice.candidates import baseline, candidates_of
from ..choice.kernel import Emitted, Rejected, Timed, Verified, verdict_of
from ..choice.lookup import with_compiler_found
from ..choice.modelling import frame_bound, lanes_in_flight, loop_report
from ..choice.selection import Selected
from ..choice.timing import job_of, timed_together
from ..choice.workbench import Workbench
from ..evidence.profiling.passes import steps_a_collision
from ..evidence.timing.ratios import TimingResult
from ..evidence.verification.errors import Array
from ..targets.target import Target
from ..toolchain.mca import find_mca

COUNTED = 2000  # cases whose steps are counted, of an exact kernel


@dataclass(frozen=True)
class BenchRow:
    """One kernel, verified and timed."""

    candidate: Timed | Rejected
    is_selected: bool
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


def bench_rows(
    tools: Workbench, target: Target, scene: str, entries: Sequence[Selected], seconds: float
) -> list[BenchRow]:
    """Verify and time, model by model, the entries and the baseline."""
    rows: list[BenchRow] = []
    for model in dict.fromkeys(entry.model for entry in entries):
        own = [e for e in entries if e.model == model]
        first = baseline(own[0].variant.question.contest, list(tools.compilers))
        variants = [first]
        for entry in own:
            found = with_compiler_found(entry.variant, tools.compilers)  # type: ignore[arg-type]
            variants.append(found)
        emitted = tools.emit_all(variants, target)
        kernels = tools.each("building and verifying", tools.check, emitted)
        single = [k for k in kernels if not k.is_batch]
        wide = [k for k in kernels if k.is_batch]
        singles, _ = _timed(tools, single, [], seconds)
        rows += [BenchRow(k, n > 0) for n, k in enumerate(singles)]
        batches, ghz = _timed(tools, single, wide, seconds) if wide else ([], None)
        cases = tools.cases.timed(scene, model, batches=True)
        rows += [_batch_row(tools, k, target, ghz, cases) for k in batches]
    return rows


def _timed(
    tools: Workbench,
    single: Sequence[Verified | Rejected],
    wide: Sequence[Verified | Rejected],
    seconds: float,
) -> tuple[list[Timed | Rejected], float | None]:
    """Kernels interleaved with the baseline, the first of the single ones; the core's clock.

    Those with lanes where there are any, beside the single ones; else the single ones.
    """
    asked = wide or single
    rejected = [k for k in asked if isinstance(k, Rejected)]
    if len(rejected) == len(asked):
        return list(rejected), None
    job = job_of([*single, *wide], seconds)
    made = timed_together(tools.time, job, tools.progress)
    return made.told(asked), made.rounds.whole.core_ghz


def _batch_row(
    tools: Workbench,
    candidate: Timed | Rejected,
    target: Target,
    ghz: float | None,
    cases: Array,
) -> BenchRow:
    if isinstance(candidate, Rejected):
        return BenchRow(candidate, True)
    threads = tools.tool.threads(candidate.library.path, cases)
    return BenchRow(candidate, True, _bound_cycles(tools, candidate, target, cases), ghz, threads)


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
