"""What a search found, as a document."""

from __future__ import annotations

from typing import Any

from generator.challenge.envelope import Envelope
from generator.challenge.kept import csv_row, hexfloats
from generator.challenge.search import Finding, Result
from generator.variants.names import name_of
from generator.variants.variant import Variant


def document(
    variant: Variant, within: Envelope, batch: bool, seed: int, cpu: str, found: Result
) -> dict[str, Any]:
    """All of a search: what was searched where, how much, and the findings to the last bit."""
    return {
        "schema": 1,
        "kernel": name_of(variant),
        "batch": batch,
        "budget": variant.stepper.budget,
        "model": variant.model,
        "envelope": within.extent,
        "ranges": {"u_b": within.u_b, "u_s": within.u_s, "e_b": within.e_b},
        "seed": seed,
        "cpu": cpu,
        "evaluations": found.evaluations,
        "seconds": round(found.seconds, 2),
        "held": found.held,
        "worst": _finding(found.worst),
        "over": [_finding(f) for f in found.over],
        "apart": [_finding(f) for f in found.apart],
    }


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        "kind": finding.kind,
        "error_over_budget": finding.over,
        "rounding_moves_exact_by": finding.moved,
        "status": finding.status,
        "csv": csv_row("found_by_search", finding.case),
        "hex": hexfloats(finding.case),
    }
