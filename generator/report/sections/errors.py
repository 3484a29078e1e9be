"""Errors against the exact result: of each output, the worst inputs, and kind by kind."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ...evidence.verification.reference import CASE_NAMES, OUTCOME_NAMES
from ..findings import KernelFindings
from ..known import Known
from ..layout import (
    Block,
    Code,
    Column,
    Details,
    Heading,
    Lines,
    Number,
    Paragraph,
    Piece,
    Section,
    Table,
    number,
    records,
    text,
)


def outputs(known: Known) -> Section:
    rows = [{"role": k.role, "errors": k.outputs} for k in known.kernels if k.outputs]
    names = [number(name, "error", "errors", name) for name in OUTCOME_NAMES]
    caption = (
        "Largest error of any case against the exact result, spins as R w, relative to |v1 \u2212 "
        "v2|"
    )
    table = records(("outputs",), rows, [text("kernel for", "role"), *names], caption)
    missing = known.unmeasured("outputs")
    shown = [table] if rows else []
    return Section("outputs", "Outputs", "Error of each output", {"outputs": rows}, shown, missing)


def worst(known: Known) -> Section:
    rows = [_worst(kernel, known.model) for kernel in known.kernels if kernel.worst]
    blocks = [block for n, row in enumerate(rows) for block in _worst_blocks(n, row)]
    missing = known.unmeasured("worst")
    return Section("worst", "Worst inputs", "Worst inputs", {"worst": rows}, blocks, missing)


def _worst(kernel: KernelFindings, model: str) -> dict[str, Any]:
    goal = f"--steps {kernel.steps}" if kernel.steps else f"--max-error {kernel.budget:g}"
    found = kernel.worst.model_dump() if kernel.worst else {}
    header, row = ",".join(("id", *CASE_NAMES)), ",".join(("worst", *found["inputs"]))
    return {
        "role": kernel.role,
        "kernel": kernel.name,
        **found,
        "names": CASE_NAMES,
        "outputs": OUTCOME_NAMES,
        "commands": (
            f"printf '%s\\n' {header} {row} > worst.csv",
            f"./gen collide --cases worst.csv --out outcome.csv --model {model} {goal}",
        ),
    }


def _worst_blocks(n: int, row: dict[str, Any]) -> list[Block]:
    def table(head: tuple[str, ...], *columns: tuple[str, ...]) -> Table:
        rows = zip(*columns, strict=True)
        return Table(head, [[[name], *([Code(value)] for value in own)] for name, *own in rows])

    note = (
        "The command runs the kernel that generated/ holds for the goal, which is this one where "
        "it was chosen."
    )
    inside: list[Block] = [
        Paragraph([note], "soft"),
        Lines(row["commands"]),
        table(("input", "value"), row["names"], row["inputs"]),
        table(("output", "of the kernel", "exact"), row["outputs"], row["got"], row["exact"]),
    ]
    head: list[Piece] = [
        f"{row['role']}: ",
        Number("error", ("worst", n, "error")),
        f" in {row['label']}",
    ]
    summary = "Its numbers as hexadecimal floats, and the commands that repeat it"
    return [Heading(head), Details(summary, inside)]


def kinds(known: Known) -> Section:
    kernels = [kernel for kernel in known.kernels if kernel.kinds]
    rows = [
        {
            "kind": kind,
            "cases": max(k.kinds[kind].cases for k in kernels if kind in k.kinds),
            "cells": {
                k.role: k.kinds[kind].model_dump(exclude={"cases"})
                for k in kernels
                if kind in k.kinds
            },
        }
        for kind in sorted({kind for kernel in kernels for kind in kernel.kinds})
    ]
    columns: list[Column] = [text("kind", "kind"), number("cases", "count", "cases")]
    for role in (k.role for k in kernels):
        columns += [
            number("error", "error", "cells", role, "error"),
            number("ns", "ns", "cells", role, "ns"),
            number("evaluations", "mean", "cells", role, "evaluations"),
        ]
    caption = (
        "Largest error against the exact result; mean time, ns; mean evaluations of the slips' "
        "rates (iterations, of fixed steps)"
    )
    table = records(("kinds",), rows, columns, caption)
    table = replace(table, groups=[("", 2), *((kernel.role, 3) for kernel in kernels)])
    title, missing = "The hard kinds, one by one", known.unmeasured("kinds")
    return Section("kinds", "Hard kinds", title, {"kinds": rows}, [table] if rows else [], missing)
