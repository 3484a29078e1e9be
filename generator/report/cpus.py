"""CPUs against CPUs: what the kernel that one's records choose costs on another."""

from __future__ import annotations

from ..evidence.records.evidence import NEGLIGIBLE, Timings
from ..evidence.records.recipe import variant_of_recipe
from ..evidence.records.record import TimingRecord
from .data import CpuCost


def cpu_costs(timings: Timings, scene: str, model: str) -> list[CpuCost]:
    """A row for each contest of a scene and model and pair of CPUs that both have timed it."""
    found: list[CpuCost] = []
    names = sorted({name for cpu in timings.by_cpu for name in timings.contests(cpu)})
    for contest in (name for name in names if name.split("/")[:2] == [scene, model]):
        there = {cpu: timings.contest(cpu, contest) for cpu in sorted(timings.by_cpu)}
        there = {cpu: records for cpu, records in there.items() if records}
        for made_for, own in there.items():
            recipe = _chosen(f"{made_for}/{contest}", own)
            for timed_on, records in there.items():
                least = next(iter(records.values())).ratio
                cost = records[recipe].ratio / least if recipe in records else None
                found.append(CpuCost(contest, made_for, timed_on, recipe, cost, len(records)))
    return found


def _chosen(contest: str, records: dict[str, TimingRecord]) -> str:
    """As a choice by records has it: of the fastest within 1 % the fewest options."""
    least = next(iter(records.values())).ratio
    close = [recipe for recipe, record in records.items() if record.ratio <= NEGLIGIBLE * least]
    return min(close, key=lambda r: variant_of_recipe(contest, r).distance_from_default())
