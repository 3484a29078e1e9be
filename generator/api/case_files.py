"""Cases of a user's file, and outcomes as CSV."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path

from ..evidence.verification.case_table import read_table
from ..evidence.verification.errors import Array
from ..registry.question import DEFAULT_IMPACT, find_impact


@dataclass(frozen=True)
class CaseTable:
    """Rows in the columns of an impact, with the ids as they were written."""

    ids: tuple[str, ...]
    rows: Array


def read_cases(path: Path, impact: str = DEFAULT_IMPACT) -> CaseTable:
    """Cases by header name, extra columns ignored. InputError names file, row and column."""
    row = find_impact(impact)
    limits = {p.name: (p.low, p.high) for p in row.parameters}
    table = read_table(path, ("id", *row.columns.case))
    return CaseTable(table.texts("id"), table.numbers(row.columns.case, limits))


def outcome_text(ids: tuple[str, ...], outcomes: Array, impact: str = DEFAULT_IMPACT) -> str:
    """CSV of outcomes: id, velocities, status; numbers that read back to the same double."""
    columns = find_impact(impact).columns
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["id", *columns.velocities, "status"])
    for identity, row in zip(ids, outcomes, strict=True):
        velocities = (repr(float(x)) for x in row[: columns.status])
        writer.writerow([identity, *velocities, int(row[columns.status])])
    return stream.getvalue()
