"""Batches against single calls, and what one CPU's choice costs on another."""

from __future__ import annotations

from typing import Any

from ...evidence.records.evidence import NEGLIGIBLE, Timings
from ...evidence.records.record import TimingRecord
from ...registry.variant import Variant
from ..findings import CallPoint
from ..known import Known
from ..layout import (
    Block,
    Code,
    Column,
    Number,
    Paragraph,
    Section,
    code,
    number,
    ratio,
    records,
    text,
)

_CALLS = (
    "Through carom_collide and carom_collide_batch, all with the same parameters but u_b; ratios "
    "are to the scalar call of the same goal in the same rounds."
)
_NO_LANES = (
    "no kernel with lanes was chosen by a stored sweep or lies in generated/; ./gen sweep --call "
    "batch looks for one"
)
_CPUS = (
    "By the records in timings/: what the kernel that one CPU's records choose takes on another, "
    "of the fastest that was timed there."
)
_NO_RECORDS = "no CPU has records of it in timings/: ./gen results refresh"


def calls(known: Known) -> Section:
    points = known.findings.calls if known.findings else ()
    rows = [call_row(point) for point in points]
    missing = known.unmeasured("calls")
    if known.findings and not any(point.width > 1 for point in points):
        missing = {"lanes": _NO_LANES}
    columns = [
        text("kernel for", "role"),
        text("call", "call"),
        number("lanes", "count", "width"),
        number("time, ns", "ns", "ns"),
        ratio("of the scalar call (95 %)"),
        code("kernel", "kernel"),
    ]
    blocks: list[Block] = [
        Paragraph([_CALLS]),
        *(Paragraph(["Not known: ", reason], "note") for reason in missing.values()),
        records(("calls",), rows, columns),
    ]
    shown = blocks if rows else []
    return Section("calls", "SPMD", "SPMD against sequential", {"calls": rows}, shown, missing)


def call_row(point: CallPoint) -> dict[str, Any]:
    timed = {key: getattr(point.timed, key) for key in ("ns", "ratio", "ratio_ci")}
    return {**point.model_dump(exclude={"timed"}), **timed}


def cpus(known: Known) -> Section:
    rows = cpu_costs(known.timings, known.scene, known.model)

    def cost(at: tuple[str | int, ...], row: Any) -> list[Number | str | Code]:
        return [Number("ratio", (*at, "cost")) if row["cost"] else "not timed"]

    columns = [
        text("contest", "contest"),
        text("chosen for", "made_for"),
        text("timed on", "timed_on"),
        Column("of the fastest there", cost, numeric=True),
        number("recipes timed there", "count", "records"),
        code("recipe", "recipe"),
    ]
    blocks: list[Block] = [Paragraph([_CPUS]), records(("cpus",), rows, columns)]
    missing = {} if rows else {"cpus": _NO_RECORDS}
    shown = blocks if rows else []
    return Section("cpus", "CPUs", "CPUs against CPUs", {"cpus": rows}, shown, missing)


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
                found.append(
                    {
                        "contest": str(contest),
                        "made_for": made_for,
                        "timed_on": timed_on,
                        "recipe": f"{chosen.question.width} {chosen.recipe}",
                        "cost": timed[chosen].ratio / least if chosen in timed else None,
                        "records": len(timed),
                    }
                )
    return found


def _chosen(records: dict[Variant, TimingRecord]) -> Variant:
    """As a choice by records has it: of the fastest within 1 % the fewest options."""
    least = next(iter(records.values())).ratio
    close = [kernel for kernel, record in records.items() if record.ratio <= NEGLIGIBLE * least]
    return min(close, key=lambda kernel: kernel.distance_from_default())
