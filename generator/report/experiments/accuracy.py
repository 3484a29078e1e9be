"""Errors of kernels against the exact result: by output, by kind, and the worst input of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...choice.verifying import Expected
from ...evidence.timing.bench_tool import BenchTool
from ...evidence.verification.errors import SLIPS, Array, Measure, component_errors
from ...evidence.verification.evidence import evidence_of
from ..findings import WorstInput

Rows = NDArray[np.int_]


@dataclass(frozen=True)
class Accuracy:
    """Largest errors of one kernel, relative as its impact measures them, spins as R w."""

    largest: float
    slipping: float  # without contacts that stick
    outputs: dict[str, float]
    by_case: Array
    worst: WorstInput


def accuracy_of(tool: BenchTool, library: Path, expected: Expected) -> Accuracy:
    """Run all cases through a kernel."""
    cases, exact, columns = expected.cases, expected.exact, tool.columns
    measure, status = evidence_of(tool.impact).measure, columns.status
    got = tool.run_kernel(library, cases, timeout=300.0)
    relative = measure.errors_of(cases, got, exact).relative
    relative = np.where(got[:, status] == exact[:, status], relative, np.inf)
    worst = int(np.argmax(relative))
    return Accuracy(
        largest=float(relative.max()),
        slipping=float(relative[exact[:, columns.sticks] == SLIPS].max(initial=0.0)),
        outputs=_by_output(measure, cases, got, exact),
        by_case=relative,
        worst=WorstInput(
            label=expected.labels[worst],
            error=float(relative[worst]),
            inputs=_hexadecimal(cases[worst]),
            got=_hexadecimal(got[worst, :status]),
            exact=_hexadecimal(exact[worst, :status]),
        ),
    )


def _hexadecimal(row: Array) -> tuple[str, ...]:
    return tuple(float(x).hex() for x in row)


def _by_output(measure: Measure, cases: Array, got: Array, exact: Array) -> dict[str, float]:
    names = measure.columns.velocities
    difference = component_errors(got[:, : len(names)], exact[:, : len(names)])
    difference[:, measure.columns.spins_after] *= measure.radius(cases)
    with np.errstate(invalid="ignore", divide="ignore"):
        relative = np.where(difference == 0, 0.0, difference / measure.speed(cases)[:, None])
    return {name: float(relative[:, n].max()) for n, name in enumerate(names)}


def kinds_of(labels: Sequence[str]) -> dict[str, Rows]:
    """Rows of each kind, by the kind that a label ends with; the paper's single cases as one."""
    found: dict[str, list[int]] = {}
    for row, label in enumerate(labels):
        kind = label[label.rindex("(") + 1 : -1]
        for family in ("seed_case", "mathavan_2014_shot"):
            kind = family if kind.startswith(family) else kind
        found.setdefault(kind, []).append(row)
    return {kind: np.array(rows, dtype=int) for kind, rows in found.items()}
