"""A kernel verified and timed, as a row of figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..choice.candidates import baseline
from ..choice.lookup import with_compiler_found
from ..choice.modelling import frame_bound, lanes_in_flight, loop_report
from ..choice.selection import Selected
from ..choice.workbench import VERIFY_RANDOM, VERIFY_SEED, Candidate, Workbench
from ..evidence.profiling.passes import steps_a_collision
from ..evidence.verification.errors import Array
from ..impacts.ball_ball.scene import find_scene
from ..targets.target import Target
from ..toolchain.mca import find_mca

COUNTED = 2000  # cases whose steps are counted, of an exact kernel


@dataclass(frozen=True)
class BenchRow:
    """One kernel, verified and timed."""

    candidate: Candidate
    is_selected: bool
    bound_cycles: float | None = None  # of a batch kernel: llvm-mca's throughput bound a collision
    core_ghz: float | None = None  # while it was timed
    threads: dict[int, float] | None = None  # ns a collision of a batch shared over threads

    @property
    def rejected(self) -> str:
        """Why the kernel failed; empty where it did not."""
        return self.candidate.rejected

    @property
    def steps(self) -> int | None:
        """Fixed steps; None: an exact kernel."""
        return self.candidate.variant.stepper.steps

    def document(self) -> dict[str, Any]:
        """The row as `gen bench --json` writes it."""
        c, v = self.candidate, self.candidate.variant
        timing, verdict = c.timing, c.verdict
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
            "compiler": c.compiler.version,
            "flags": " ".join(c.flags),
            "options": dict(v.options),
            "ns_per_collision": timing.ns if timing else None,
            "latency_ns": timing.latency_ns if timing else None,
            "tsc_cycles_per_collision": timing.cycles if timing else None,
            "ratio_to_baseline": timing.ratio if timing else None,
            "ratio_ci": list(timing.ratio_ci) if timing else None,
            "max_rel_error": verdict.max_rel_error if verdict else None,
            "error_against": f"euler_n{v.stepper.steps}" if v.stepper.steps else "exact",
            "bound_cycles_per_collision": self.bound_cycles,
            "core_ghz": self.core_ghz,
            "ns_by_threads": self.threads,
            "selected": self.is_selected,
            "rejected": c.rejected or None,
        }

    @property
    def of_bound(self) -> float | None:
        """How many times what its loops' instructions allow a batch kernel takes, if known."""
        timing = self.candidate.timing
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
        first = baseline(target, scene, model, 1000, list(tools.compilers))
        variants = [first]
        for entry in own:
            found = with_compiler_found(entry.variant, tools.compilers)  # type: ignore[arg-type]
            variants.append(found)
        candidates = tools.prepare(variants, target)
        tools.compile(candidates)
        expected = tools.expected(scene, model, 1000, VERIFY_SEED, VERIFY_RANDOM)
        tools.verify(candidates, expected)
        tools.verify_at_worst(candidates, expected)
        single = [c for c in candidates if c.variant.width == 1]
        wide = [c for c in candidates if c.variant.width > 1]
        ghz = None
        if any(not c.rejected for c in wide):
            run = tools.time([*single, *wide], candidates[0], scene, seconds, batches=True)
            ghz = run.core_ghz
        tools.time(single, candidates[0], scene, seconds)
        rows += [BenchRow(c, c is not candidates[0]) for c in single]
        cases = tools.batch_cases(scene, model)
        rows += [_batch_row(tools, c, target, ghz, cases) for c in wide]
    return rows


def _batch_row(
    tools: Workbench, candidate: Candidate, target: Target, ghz: float | None, cases: Array
) -> BenchRow:
    if candidate.rejected or candidate.library is None:
        return BenchRow(candidate, True)
    threads = tools.tool.threads(candidate.library.path, cases)
    return BenchRow(candidate, True, _bound_cycles(tools, candidate, target, cases), ghz, threads)


def _bound_cycles(
    tools: Workbench, candidate: Candidate, target: Target, cases: Array
) -> float | None:
    """Cycles that a collision needs at least in the loops of a batch kernel, all lanes busy.

    Its steps; in an exact kernel also reading, checking and writing it, which the N steps of others
    outweigh. None where there is no such loop, or no llvm-mca.
    """
    variant = candidate.variant
    if find_mca() is None or find_scene(variant.scene).level:
        return None
    steps: float | None = variant.stepper.steps
    around = 0.0
    if steps is None:
        cache = tools.cache / "kernels"
        steps = steps_a_collision(variant, candidate.compiler, target, cases[:COUNTED], cache)
        around = frame_bound(tools, candidate, target)
    report = loop_report(tools, candidate, target)
    return report.throughput_bound * steps / lanes_in_flight(variant) + around
