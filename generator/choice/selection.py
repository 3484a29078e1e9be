"""selection.json: which kernels stand in a folder of generated/, and why. Small and readable."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from ..errors import InputError

FILE = "selection.json"
ChosenBy = Literal["timing", "records", "llvm-mca", "default"]  # records: timed earlier


class Selected(BaseModel):
    """One kernel that was chosen, and on what grounds."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    kernel: str  # full name in the grammar of variants.names, compiler and flags included
    file: str
    model: str
    stepper: str
    steps: int | None
    budget: float | None
    width: int
    chosen_by: ChosenBy
    measured_on: str  # the CPU that was timed or modelled
    evidence: str = ""  # which CPU was timed, when, how many kernels, how many of earlier code
    ratio_to_baseline: float | None  # of time, or of modelled cycles
    ratio_ci: tuple[float, float] | None
    max_rel_error: float | None
    # The largest error under the worst root estimates allowed; None: no estimate enters.
    worst_estimate_error: float | None = None
    search: str = ""  # the largest error that a search found; begins with OVER where it is over
    error_against: Literal["exact", "euler"]
    ties: list[str]

    @property
    def grounds(self) -> str:
        """For a banner: what the choice rests on, and what it was held to."""
        if self.worst_estimate_error is None:
            return self.evidence
        worst = f"largest error under the worst root estimates {self.worst_estimate_error:g}"
        return "; ".join(text for text in (self.evidence, worst) if text)


class Selection(BaseModel):
    """The file: entries sorted by model, stepper and width."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    schema_version: Literal[1] = 1
    target: str
    resolved: str  # the target that `native` stood for, else the target itself
    scene: str
    kernels: list[Selected]

    def find(
        self, model: str, steps: int | None = None, budget: float | None = None, width: int = 1
    ) -> Selected | None:
        """The entry for a model: with fixed steps (any number of them) or with a budget."""
        for entry in self.kernels:
            if (entry.model, entry.width) != (model, width):
                continue
            if steps is not None and entry.stepper == "euler":
                return entry
            if budget is not None and entry.budget == budget:
                return entry
        return None

    def find_batch(
        self, model: str, steps: int | None = None, budget: float | None = None
    ) -> Selected | None:
        """As `find`, for lanes: the best of several widths."""
        widths = sorted({entry.width for entry in self.kernels if entry.width > 1})
        found = (self.find(model, steps, budget, width) for width in widths)
        return min((entry for entry in found if entry), key=batch_rank, default=None)

    def with_entries(self, entries: list[Selected]) -> Selection:
        """Entries replaced or added; the rest as it was. A goal has one batch kernel."""
        kept = {_key(entry): entry for entry in self.kernels}
        kept.update({_key(entry): entry for entry in entries})
        ordered = [kept[key] for key in sorted(kept)]
        return self.model_copy(update={"kernels": ordered})

    def text(self) -> str:
        return json.dumps(self.model_dump(mode="json"), indent=2) + "\n"


def batch_rank(entry: Selected) -> tuple[float, int]:
    """By which the least is best: the fastest; the widest where nothing was timed."""
    ratio = float("inf") if entry.ratio_to_baseline is None else entry.ratio_to_baseline
    return ratio, -entry.width


def _key(entry: Selected) -> tuple[str, str, str, bool]:
    goal = f"n{entry.steps:09d}" if entry.steps is not None else f"e{entry.budget:.17e}"
    return entry.model, entry.stepper if entry.steps is not None else "exact", goal, entry.width > 1


def read_selection(folder: Path) -> Selection | None:
    """The selection of a folder, or None where there is none. InputError names what is wrong."""
    path = folder / FILE
    if not path.exists():
        return None
    try:
        return Selection(**json.loads(path.read_text("utf-8")))
    except (ValueError, TypeError) as error:
        first = error.errors()[0] if isinstance(error, ValidationError) else None
        where = ".".join(str(part) for part in first["loc"]) if first else "(file)"
        reason = first["msg"] if first else str(error)
        raise InputError(
            f"{path}: {where}: {reason}; remove it, then ./gen --target {folder.parent.name} "
            f"--scene {folder.name} makes it anew"
        ) from None
