"""CPUs against CPUs: what the kernel that one's records choose costs on another."""

from __future__ import annotations

from typing import Any

from ...evidence.records.evidence import NEGLIGIBLE, Timings
from ...evidence.records.record import TimingRecord
from ...registry.variant import Variant


def cpu_costs(timings: Timings, scene: str, model: str) -> list[dict[str, Any]]:
    """A row for each contest of a scene and model and pair of CPUs that both have timed it.

    `cost`: None where that CPU has not timed the recipe; `records`: recipes that it has timed.
    """
    found = []
    contests = sorted({c for cpu in timings.by_cpu for c in timings.contests(cpu)}, key=str)
    for contest in (each for each in contests if (each.scene, each.model) == (scene, model)):
        there = {cpu: timings.contest(cpu, contest) for cpu in sorted(timings.by_cpu)}
        there = {cpu: timed for cpu, timed in there.items() if timed}
        for made_for, own in there.items():
            chosen = _chosen(own)
            for timed_on, timed in there.items():
                least = next(iter(timed.values())).ratio
                cost = timed[chosen].ratio / least if chosen in timed else None
                row = {"contest": str(contest), "made_for": made_for, "timed_on": timed_on}
                recipe = f"{chosen.question.width} {chosen.recipe}"
                found.append({**row, "recipe": recipe, "cost": cost, "records": len(timed)})
    return found


def _chosen(records: dict[Variant, TimingRecord]) -> Variant:
    """As a choice by records has it: of the fastest within 1 % the fewest options."""
    least = next(iter(records.values())).ratio
    close = [kernel for kernel, record in records.items() if record.ratio <= NEGLIGIBLE * least]
    return min(close, key=lambda kernel: kernel.distance_from_default())
