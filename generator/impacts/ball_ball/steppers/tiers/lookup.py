"""Which certificate is for a contact model and a budget."""

from __future__ import annotations

from dataclasses import dataclass

from ...terms import ContactTerms
from .bounds import Bound
from .weights import BOTTOM_1E3, BOTTOM_1E6, LIFT_1E6, TOP_1E3, TOP_1E6


@dataclass(frozen=True)
class _Row:
    """The certificates of a contact model for budgets from `least` on."""

    terms: ContactTerms
    least: float
    bound: Bound


_ROWS: tuple[_Row, ...] = (  # of a model's the one for the largest budgets first
    _Row(ContactTerms("bottom", lift=True), 1e-3, BOTTOM_1E3),
    _Row(ContactTerms("bottom", lift=False), 1e-3, BOTTOM_1E3),
    _Row(ContactTerms("top", lift=False), 1e-3, TOP_1E3),
    _Row(ContactTerms("bottom", lift=True), 1e-6, LIFT_1E6),
    _Row(ContactTerms("bottom", lift=False), 1e-6, BOTTOM_1E6),
    _Row(ContactTerms("top", lift=False), 1e-6, TOP_1E6),
)


def bound_for(terms: ContactTerms, budget: float) -> Bound:
    """The certificates for a budget. ValueError where none are known (tiers.py of the impact)."""
    for row in _ROWS:
        if row.terms == terms and budget >= row.least:
            return row.bound
    raise ValueError(f"no certificate is known for {terms} and {budget:g}")
