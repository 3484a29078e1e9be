"""What a search found, as a document and as a case that can be run again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...registry.names import name_of
from ...registry.variant import Variant
from .kept import csv_row, hexfloats
from .search import Finding, Result, Subject


def document(
    variant: Variant, subject: Subject, seed: int, cpu: str, found: Sequence[Result]
) -> dict[str, Any]:
    """All of a search: what was searched where, how much, and the findings to the last bit."""
    within, names = subject.within, subject.tool.columns.case
    return {
        "kernel": name_of(variant),
        "question": str(variant.question),
        "recipe": str(variant.recipe),
        "batch": subject.batch,
        "budget": subject.budget,
        "model": variant.model,
        "envelope": within.extent,
        "ranges": dict(within.ranges),
        "seed": seed,
        "cpu": cpu,
        "hunts": {result.hunt: _hunt(result, names) for result in found},
    }


def _hunt(result: Result, names: Sequence[str]) -> dict[str, Any]:
    return {
        "evaluations": result.evaluations,
        "seconds": round(result.seconds, 2),
        "held": result.held,
        "worst": _finding(result.worst, names),
        "over": [_finding(f, names) for f in result.over],
        "apart": [_finding(f, names) for f in result.apart],
    }


def _finding(finding: Finding, names: Sequence[str]) -> dict[str, Any]:
    return {
        "kind": finding.kind,
        "over": finding.over if finding.over != float("inf") else None,
        "rounding_moves_exact_by": finding.moved,
        "status": finding.status,
        "csv": csv_row("found_by_search", finding.case),
        "hex": hexfloats(finding.case, names),
    }
