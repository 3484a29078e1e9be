"""What a kernel executes: operations counted, time by section, branch and cache misses."""

from __future__ import annotations

from typing import Any

from ...evidence.profiling.sections import SECTIONS
from ..drawing import Note
from ..known import Known
from ..layout import (
    Block,
    Column,
    Paragraph,
    Plots,
    Section,
    number,
    records,
    text,
)
from ..plots import Key, Plot, Row, Rows, share_rows

_COUNTED = (
    "Counted by running the kernel's text with a number type that counts. Of a step: the usual "
    "iteration of the fixed-step loop, or a step of an exact kernel without the control of its "
    "length and the making of inverse roots; it equals what the generated file states."
)
_COLLISION = (
    "Of one collision, mean over the timed cases; flops count an FMA as two; cycles are those of "
    "the time stamp counter"
)
_REFUSED = (
    "Guesses refused: share of the loop's iterations in which 1/|c| refined from earlier values "
    "was too far off, so that the root itself was made."
)
_SAMPLED = (
    "A timer asks where the kernel stands. Pre-loop: the frame, checks and start. Impulse: slips' "
    "lengths, directions and impulses of a step, or the rates of an exact one. Update: what the "
    "loop carries, its control, its ends. Post-loop: from the impulses back to velocities. A core "
    "works on several at once; a sample counts for the one that it finds waiting."
)
_SIMULATED = (
    "Valgrind's caches and branch predictor are models of its own, not this CPU's, and it knows no "
    "AVX-512: where the figures are its simulation, the kernel was built for another target."
)


def operations(known: Known) -> Section:
    rows = []
    for kernel in known.kernels:
        if kernel.counts:
            cycles = kernel.timed.cycles if kernel.timed else None
            per_cycle = kernel.counts.flops / cycles if cycles else None
            counted = kernel.counts.model_dump()
            more = {"cycles": cycles, "flops_per_cycle": per_cycle}
            rows.append({"role": kernel.role, **counted, **more})
    kinds = list(rows[0]["per_collision"]) if rows else []
    role = text("kernel for", "role")
    step = [number(kind, "count", "per_step", kind) for kind in kinds]
    whole = [number(kind, "mean", "per_collision", kind) for kind in kinds]
    whole += [
        number("evaluations", "mean", "evaluations"),
        number("flops", "count", "flops"),
        number("cycles", "cycles", "cycles"),
        number("flops per cycle", "times", "flops_per_cycle"),
        number("guesses refused", "percent", "refused"),
    ]
    at = ("operations",)
    blocks: list[Block] = [
        Paragraph([_COUNTED]),
        records(at, rows, [role, *step, text("its file states", "stated")], "Of one step"),
        records(at, rows, [role, *whole], _COLLISION),
        Paragraph([_REFUSED], "soft"),
    ]
    title, missing = "Operations, before and after", known.unmeasured("operations")
    data, shown = {"operations": rows}, blocks if rows else []
    return Section("operations", "Operations", title, data, shown, missing)


def sections(known: Known) -> Section:
    rows = [
        {
            "role": kernel.role,
            **kernel.sections.model_dump(),
            "ns": {n: share * kernel.timed.ns for n, share in kernel.sections.shares.items()},
        }
        for kernel in known.kernels
        if kernel.sections and kernel.timed
    ]
    columns: list[Column] = [text("kernel for", "role")]
    for name in rows[0]["shares"] if rows else ():
        columns += [number(name, "percent", "shares", name), number("ns", "mean", "ns", name)]
    columns += [number("no line", "percent", "unknown"), number("samples", "count", "samples")]
    blocks: list[Block] = [
        Paragraph([_SAMPLED]),
        Plots([_shares(rows)]),
        records(("sections",), rows, columns),
    ]
    title, missing = "Sections of the kernel", known.unmeasured("sections")
    data, shown = {"sections": rows}, blocks if rows else []
    return Section("sections", "Sections", title, data, shown, missing)


def _shares(rows: list[dict[str, Any]]) -> Plot:
    drawn = []
    for n, row in enumerate(rows):
        shares = {f"shares/{name}": row["shares"][name] for name in SECTIONS}
        shares["unknown"] = row["unknown"]
        names = (*SECTIONS, "no line")
        notes = [
            Note(f"{row['role']}, {name}: {100 * share:.1f} %", f"/sections/{n}/{at}")
            for name, (at, share) in zip(names, shares.items(), strict=True)
        ]
        drawn.append(Row(row["role"], list(shares.values()), notes))
    legend = [Key("bar", n, name) for n, name in enumerate((*SECTIONS, "no line"))]
    label = "share of the samples of the program counter, %"
    return share_rows(Rows("sections", "Where the time goes", label, drawn, legend, ()))


def misses(known: Known) -> Section:
    rows = [{"role": k.role, **m.model_dump()} for k in known.kernels for m in k.misses]
    events = list(rows[0]["events"]) if rows else []
    columns = [
        text("kernel for", "role"),
        *(number(event.replace("_", " "), "mean", "events", event) for event in events),
        Column("by", lambda _, row: [f"{row['source']} ({row['by']})"]),
        text("built for", "built_for"),
    ]
    blocks: list[Block] = [
        records(("misses",), rows, columns, "Of one collision"),
        Paragraph([_SIMULATED], "soft"),
    ]
    untold = {
        what: reason
        for what, reason in known.untold.items()
        if what.startswith(("misses of", "hardware counters of"))
    }
    lines = [Paragraph([f"{w}: not available: {why}"], "soft") for w, why in untold.items()]
    shown = [*(blocks if rows else ()), *lines]
    title, missing = "Branch and cache misses", known.unmeasured("misses")
    return Section("misses", "Misses", title, {"misses": rows}, shown, missing)
