"""The rows of gen bench."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from generator.choice.candidates import baseline
from generator.choice.lookup import with_compiler_found
from generator.choice.selection import Selected
from generator.choice.workbench import VERIFY_RANDOM, VERIFY_SEED, Candidate, Workbench
from generator.targets.target import Target
from generator.variants.names import variant_of


@dataclass(frozen=True)
class BenchRow:
    """One kernel, verified and timed."""

    candidate: Candidate
    is_selected: bool

    @property
    def rejected(self) -> str:
        return self.candidate.rejected

    def document(self) -> dict[str, Any]:
        """The row as ../shared/interface.md documents it, and more."""
        c, v = self.candidate, self.candidate.variant
        timing, verdict = c.timing, c.verdict
        return {
            "name": c.name,
            "target": v.target,
            "scene": v.scene,
            "model": v.model,
            "stepper": v.stepper.name,
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
            "selected": self.is_selected,
            "rejected": c.rejected or None,
        }

    def line(self) -> str:
        c = self.candidate
        if c.rejected or c.timing is None:
            return f"FAILED {c.name}: {c.rejected or 'not timed'}"
        error = "-" if c.verdict is None else f"{c.verdict.max_rel_error:.1e}"
        low, high = c.timing.ratio_ci
        return (
            f"{c.timing.ns:10.1f} ns  {c.timing.ratio:.4f} ({low:.4f}-{high:.4f}) of paper-initial"
            f"  error {error}  {c.name}"
        )


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
            found = with_compiler_found(variant_of(entry.kernel), tools.compilers)  # type: ignore[arg-type]
            variants.append(found)
        candidates = tools.prepare(variants, target)
        tools.compile(candidates)
        tools.verify(candidates, tools.expected(scene, model, 1000, VERIFY_SEED, VERIFY_RANDOM))
        tools.time(candidates, candidates[0], scene, seconds)
        rows += [BenchRow(c, index > 0) for index, c in enumerate(candidates)]
    return rows
