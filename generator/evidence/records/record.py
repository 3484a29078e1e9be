"""The record of a timing: a line of `timings/<cpu>.jsonl`. See docs/timings.md.

Field names and meanings are the stored format. A record is never changed; a new timing is a new
record.
"""

from __future__ import annotations

import json
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

from ..timing.ratios import Interval, Speed

HASH = 16  # digits that a record keeps: it is to be read

ORDER = (  # of the fields in a line
    *("question", "recipe", "ratio", "ratio_ci", "control", "ns", "rounds"),
    *("when", "origin", "cpu", "basis"),
)

# What a time depends on, as a reader calls it.
CALLED = {
    "source": "kernel text",
    "compiler": "compiler",
    "flags": "flags",
    "cases": "cases",
    "bench": "bench",
    "baseline": "baseline",
}


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Cpu(_Part):
    """The CPU that timed."""

    target: str  # its name in targets.toml
    name: str
    vendor: str
    family: int  # as cpuid and lscpu count; 0 where there is no cpuid
    model: int | None  # None: not noted

    @property
    def text(self) -> str:
        return f"{self.name} ({self.target})"


class Basis(_Part):
    """All that a time depends on. Rules of verification are none of it."""

    source: str  # hash of the kernel's code, without comments and its own name
    compiler: str  # first line of --version
    flags: str
    cases: str  # hash of the cases that it was timed on
    bench: str  # hash of the code that times
    baseline: str  # hash of code, compiler and flags of `paper-initial`

    @field_validator("source", "cases", "baseline")
    @classmethod
    def _short(cls, value: str) -> str:
        return value[:HASH]

    def changed(self, now: Basis) -> tuple[str, ...]:
        """What is another now, in a reader's words."""
        return tuple(CALLED[k] for k in CALLED if getattr(self, k) != getattr(now, k))


class TimingRecord(Speed, _Part):
    """How fast one kernel was on a CPU."""

    schema_version: Literal[1] = 1
    question: str = Field(pattern=r"^[^/ ]+(/[^/ ]+){3}$")
    recipe: str
    control: Interval | None  # the A/A band: ratios that the baseline has to itself
    rounds: int | None = Field(gt=0)
    when: str = Field(pattern=r"^\d{4}-\d\d-\d\d(T[\d:.]+Z)?$")  # UTC
    origin: str  # what timed it, and whether in company
    cpu: Cpu
    basis: Basis

    @property
    def kernel(self) -> str:
        """The name of the kernel."""
        return f"{self.question} {self.recipe}"

    @property
    def day(self) -> str:
        return self.when[:10]

    @property
    def spread(self) -> float:
        """Relative width of the interval: of two records of the same, the narrower tells more."""
        return (self.ratio_ci[1] - self.ratio_ci[0]) / self.ratio

    def line(self) -> str:
        """The record as text; the same record is the same line."""
        body = self.model_dump(mode="json")
        return json.dumps({key: body[key] for key in ORDER}, separators=(",", ":"))
