"""What was chosen as an entry of selection.json, whoever chose it, and the folder it goes to."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..evidence.timing.ratios import to_digits
from ..evidence.verification.verdict import Verdict
from ..registry.names import name_of
from ..registry.variant import Variant
from .choose import DIGITS, Choice
from .folder import checked_selection, write_folder
from .selection import Selected, Selection
from .trials import Final


def selected(choice: Choice) -> Selected:
    """The choice of the main job."""
    figures = {
        "chosen_by": choice.by,
        "measured_on": choice.measured_on,
        "evidence": choice.evidence,
        "ratio_to_baseline": choice.ratio,
        "interval": choice.interval,
        "search": choice.sought or "",
        **found_errors(choice.chosen.verdict),
    }
    return _entry(choice.chosen.variant, choice.ties, figures)


def selected_by_sweep(final: Final) -> Selected:
    """The choice of a sweep's final."""
    row = final.row(final.chosen)
    low, high = row.times.ratio_ci
    figures = {
        "chosen_by": "timing",
        "measured_on": row.subject.asked.target,
        "ratio_to_baseline": to_digits(row.times.ratio, DIGITS),
        "interval": (to_digits(low, DIGITS), to_digits(high, DIGITS)),
        "max_rel_error": _short(row.max_rel_error),
    }
    ties = [name for name in final.ties if name != final.chosen]
    return _entry(row.subject.variant(), ties, figures)


def found_errors(verdict: Verdict) -> dict[str, float | None]:
    """The errors of an entry: the largest found, and that under the worst root estimates."""
    return {
        "max_rel_error": _short(verdict.largest_error),
        "worst_estimate_error": _short(verdict.worst_estimate_error),
    }


def _short(error: float | None) -> float | None:
    return None if error is None else float(f"{error:.3g}")


def _entry(variant: Variant, ties: Sequence[str], figures: dict[str, Any]) -> Selected:
    return Selected(
        question=str(variant.question),
        recipe=str(variant.recipe),
        error_against="euler" if variant.stepper.family == "fixed" else "exact",
        ties=sorted(tie for tie in ties if tie != name_of(variant)),
        **figures,
    )


def write_selected(folder: Path, target: str, entries: Sequence[Selected]) -> None:
    """Add entries to a folder, or put them in the place of those it had for the same goals.

    `target`: as the user calls it, that of the entries or `native`.
    """
    asked = entries[0].variant.question
    selection = checked_selection(folder) or Selection(
        impact=asked.impact, target=target, resolved=asked.target, scene=asked.scene, kernels=[]
    )
    selection = selection.model_copy(update={"resolved": asked.target})
    write_folder(folder, selection.with_entries(list(entries)))
