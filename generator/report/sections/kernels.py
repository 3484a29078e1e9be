"""What was measured of each kernel, as the page's tables have it: views of its findings."""

from __future__ import annotations

from typing import Any

from ...evidence.profiling.sections import SECTIONS
from ...impacts.registry import DEFAULT, find_impact
from ..drawing import Note
from ..findings import KernelFindings, WorstInput
from ..known import Known
from ..plots import Key, Plot, Row, Rows, share_rows

Rowed = dict[str, Any]
NO_LINE = "no line"


def data(known: Known) -> dict[str, list[Rowed]]:
    """By section. Every row names the role of its kernel."""
    kernels = known.kernels
    calls = known.findings.calls if known.findings else ()
    return {
        "outputs": [{"role": k.role, "errors": k.outputs} for k in kernels if k.outputs],
        "worst": [_worst(k, k.worst, known.model) for k in kernels if k.worst],
        "kinds": _kinds([k for k in kernels if k.kinds]),
        "operations": [_operations(k) for k in kernels if k.counts],
        "sections": [_sections(k) for k in kernels if k.sections],
        "modelled": [
            {"role": k.role, **m.model_dump(), "pressure": dict(m.pressure)}
            for k in kernels
            for m in k.modelled
        ],
        "misses": [{"role": k.role, **m.model_dump()} for k in kernels for m in k.misses],
        "calls": [c.model_dump(exclude={"timed"}) | times_row(c.timed) for c in calls],
    }


def times_row(times: Any) -> Rowed:
    """What the page shows of a kernel's times, as the store and the findings have them."""
    return {name: getattr(times, name, None) for name in ("ns", "cycles", "ratio", "ratio_ci")}


def _worst(kernel: KernelFindings, worst: WorstInput, model: str) -> Rowed:
    """With the commands that repeat it."""
    goal = f"--steps {kernel.steps}" if kernel.steps else f"--max-error {kernel.budget:g}"
    columns = find_impact(DEFAULT).columns
    header, row = ",".join(("id", *columns.case)), ",".join(("worst", *worst.inputs))
    return {
        "role": kernel.role,
        "kernel": kernel.name,
        **worst.model_dump(),
        "names": columns.case,
        "outputs": columns.velocities,
        "commands": (
            f"printf '%s\\n' {header} {row} > worst.csv",
            f"./gen collide --cases worst.csv --out outcome.csv --model {model} {goal}",
        ),
    }


def _kinds(kernels: list[KernelFindings]) -> list[Rowed]:
    found = []
    for kind in sorted({kind for kernel in kernels for kind in kernel.kinds}):
        own = {k.role: k.kinds[kind] for k in kernels if kind in k.kinds}
        cells = {role: figures.model_dump(exclude={"cases"}) for role, figures in own.items()}
        cases = max(figures.cases for figures in own.values())
        found.append({"kind": kind, "cases": cases, "cells": cells})
    return found


def _operations(kernel: KernelFindings) -> Rowed:
    counts = kernel.counts.model_dump() if kernel.counts else {}
    cycles = kernel.timed.cycles if kernel.timed else None
    per_cycle = counts["flops"] / cycles if cycles else None
    return {"role": kernel.role, **counts, "cycles": cycles, "flops_per_cycle": per_cycle}


def _sections(kernel: KernelFindings) -> Rowed:
    found = kernel.sections.model_dump() if kernel.sections else {}
    ns = kernel.timed.ns if kernel.timed else float("nan")
    times = {name: share * ns for name, share in found["shares"].items()}
    return {"role": kernel.role, **found, "ns": times}


def section_plots(rows: list[Rowed]) -> list[Plot]:
    """Where the time goes, a bar for each kernel."""
    drawn = []
    for n, row in enumerate(rows):
        shares = {name: (f"shares/{name}", row["shares"][name]) for name in SECTIONS}
        shares[NO_LINE] = "unknown", row["unknown"]
        notes = [
            Note(f"{row['role']}, {name}: {100 * share:.1f} %", f"/sections/{n}/{at}")
            for name, (at, share) in shares.items()
        ]
        drawn.append(Row(row["role"], [share for _, share in shares.values()], notes))
    legend = [Key("bar", n, name) for n, name in enumerate((*SECTIONS, NO_LINE))]
    label = "share of the samples of the program counter, %"
    asked = Rows("sections", "Where the time goes", label, drawn, legend, ())
    return [share_rows(asked)] if rows else []
