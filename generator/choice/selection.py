"""selection.json: which kernels stand in a folder of generated/, and why. Small and readable."""

from __future__ import annotations

import json
from functools import cached_property
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ..errors import InputError
from ..registry.names import variant_of
from ..registry.question import DEFAULT_IMPACT, Goal
from ..registry.variant import Variant

FILE = "selection.json"
ChosenBy = Literal["timing", "records", "llvm-mca", "default"]  # records: timed earlier


class Selected(BaseModel):
    """One kernel that was chosen, and on what grounds."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, populate_by_name=True, serialize_by_alias=True
    )

    question: str
    recipe: str  # compiler and flags, too
    chosen_by: ChosenBy
    measured_on: str  # the CPU that was timed or modelled
    evidence: str = ""  # which CPU was timed, when, how many kernels, how many of earlier code
    ratio_to_baseline: float | None  # of time, or of modelled cycles
    interval: tuple[float, float] | None = Field(alias="ratio_ci")  # of that ratio, 95 %
    max_rel_error: float | None
    # The largest error under the worst root estimates allowed; None: no estimate enters.
    worst_estimate_error: float | None = None
    search: str = ""  # the largest error that a search found; begins with OVER where it is over
    error_against: Literal["exact", "euler"]
    ties: list[str]

    @model_validator(mode="after")
    def _reads(self) -> Selected:
        """Refuse names that are not known: whoever has an entry asks no more."""
        variant_of(self.kernel)
        return self

    @cached_property
    def variant(self) -> Variant:
        return variant_of(self.kernel)

    @property
    def kernel(self) -> str:
        """The name of the kernel."""
        return f"{self.question} {self.recipe}"

    @property
    def file(self) -> str:
        return self.variant.question.file

    @property
    def model(self) -> str:
        return self.variant.model

    @property
    def goal(self) -> Goal:
        return self.variant.question.goal

    @property
    def width(self) -> int:
        return self.variant.width

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

    schema_version: Literal[2] = 2
    impact: str
    target: str
    resolved: str  # the target that `native` stood for, else the target itself
    scene: str
    kernels: list[Selected]

    def find(self, model: str, goal: Goal, batch: bool = False) -> Selected | None:
        """The entry for a model: with fixed steps (any number of them) or with a budget.

        `batch`: that with lanes, the best of several widths.
        """
        found = [
            entry
            for entry in self.kernels
            if entry.model == model
            and (entry.width > 1) == batch
            and entry.goal.budget == goal.budget
        ]
        return min(found, key=batch_rank, default=None)

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


def _key(entry: Selected) -> tuple[str, str, int, float, bool]:
    goal = entry.goal
    return entry.model, goal.family, goal.steps or 0, goal.budget or 0.0, entry.width > 1


def place_of(root: Path, target: str, scene: str, impact: str = DEFAULT_IMPACT) -> Path:
    """The folder of a selection: `root` is generated/, or another that is laid out as it is."""
    return root / impact / target / scene


def how_to_make(folder: Path) -> str:
    """The command that makes a folder."""
    impact, target, scene = folder.absolute().parts[-3:]
    named = "" if impact == DEFAULT_IMPACT else f" --impact {impact}"
    return f"./gen --target {target}{named} --scene {scene}"


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
            f"{path}: {where}: {reason}; remove it, then {how_to_make(folder)} makes it anew"
        ) from None
