"""What a sweep chose as a folder of generated/."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..choice.folder import checked_selection, write_folder
from ..choice.selection import Selected, Selection
from ..registry.question import DEFAULT_IMPACT
from .finals import row_of
from .record import Final
from .space import variant_of_subject


def selected(final: Final) -> Selected:
    """The choice of a final as an entry of selection.json."""
    row = row_of(final, final.chosen)
    variant = variant_of_subject(row.subject)
    error = row.max_rel_error
    return Selected(
        question=str(variant.question),
        recipe=str(variant.recipe),
        chosen_by="timing",
        measured_on=row.subject.target,
        ratio_to_baseline=round(row.times.ratio, 4),
        ratio_ci=(round(row.times.ratio_ci[0], 4), round(row.times.ratio_ci[1], 4)),
        max_rel_error=None if error is None else float(f"{error:.3g}"),
        error_against="euler" if row.subject.steps is not None else "exact",
        ties=sorted(name for name in final.ties if name != final.chosen),
    )


def write_choices(
    folder: Path, target: str, resolved: str, scene: str, finals: Sequence[Final]
) -> None:
    """Add the choices to a folder, or put them in the place of those it had for the same goals."""
    selection = checked_selection(folder) or Selection(
        impact=DEFAULT_IMPACT, target=target, resolved=resolved, scene=scene, kernels=[]
    )
    entries = [selected(final) for final in finals]
    selection = selection.model_copy(update={"resolved": resolved})
    write_folder(folder, selection.with_entries(entries))
