"""What the page shows: plain data, all numbers of the page and nothing else. JSON by `document`.

Times are in ns for one collision, `ratio` is the time divided by that of `paper-initial` in the
same rounds, errors are relative to |v1 - v2| before the collision. None: not known; `missing` says
why, by the name of the field.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any

from pydantic import BaseModel

from .measured import CallPoint, GrowthPoint

SCHEMA = 1


@dataclass(frozen=True)
class Machine:
    cpu: str
    target: str
    system: str
    compilers: dict[str, str]
    flags: dict[str, str]  # by role
    seeds: dict[str, int]
    tsc_ghz: float | None
    control: tuple[float, float] | None  # ratios that paper-initial has to itself
    version: str
    measured_at: str | None


@dataclass(frozen=True)
class SweepSummary:
    """What the store holds of this target, scene and model."""

    commands: tuple[str, ...]  # of its runs
    from_to: tuple[str, str] | None
    trials: int
    variants: int
    timed: int
    longer: int  # trials that are not shown since the same one was timed again for longer
    outdated: int  # that are not shown since sources, compiler, cases or rules have changed
    rejected: dict[str, int]  # by reason
    examples: dict[str, str]  # one rejection of each reason, in full


@dataclass(frozen=True)
class Chosen:
    """A kernel that answers a question, against the three that it is compared with."""

    role: str
    kernel: str
    call: str
    width: int
    by: str  # what decided
    ns: float | None
    cycles: float | None
    ratio: float | None
    ratio_ci: tuple[float, float] | None
    times_faster: float | None  # than paper-initial
    than_best: float | None  # times faster than paper-best
    than_euler: float | None  # times faster than the chosen fixed-step Euler kernel
    error: float | None  # against the exact result
    verified_error: float | None  # against what it must reproduce
    ties: tuple[str, ...]


@dataclass(frozen=True)
class VariantPoint:
    """A variant that was timed. `options`: codes in the order of the contest's axes."""

    name: str
    stepper: str
    width: int
    options: tuple[str, ...]
    ns: float
    ratio: float
    ratio_ci: tuple[float, float]
    error: float
    rung: int
    tie: bool
    front: bool


@dataclass(frozen=True)
class Contest:
    """Variants that answer the same question; fastest first."""

    name: str
    goal: str
    call: str
    family: str
    against: str  # what the errors are taken against
    axes: tuple[str, ...]
    band: tuple[float, float] | None  # ratios that cannot be told from the fastest
    variants: tuple[VariantPoint, ...]


@dataclass(frozen=True)
class Effect:
    """Variants that differ in one option alone: time with `code` over time with `other`."""

    family: str
    axis: str
    code: str
    other: str
    text: str
    pairs: int
    ratio: float  # median
    ratio_ci: tuple[float, float]  # of the median, 95 %


@dataclass(frozen=True)
class PlainPoint:
    """A mark of the plot of time against the exact error that is no trial of a sweep."""

    label: str
    group: str
    ns: float
    ratio: float
    error: float


@dataclass(frozen=True)
class OutputErrors:
    role: str
    errors: dict[str, float]


@dataclass(frozen=True)
class Worst:
    role: str
    kernel: str
    label: str
    error: float
    names: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    got: tuple[str, ...]
    exact: tuple[str, ...]
    commands: tuple[str, ...]


@dataclass(frozen=True)
class KindCell:
    error: float
    ns: float | None
    evaluations: float


@dataclass(frozen=True)
class KindRow:
    kind: str
    cases: int
    cells: dict[str, KindCell]  # by role


@dataclass(frozen=True)
class GrowthFit:
    """ns = fixed + per_step * N, by least squares of relative deviations."""

    role: str
    fixed: float
    per_step: float


@dataclass(frozen=True)
class Operations:
    """Counted by running the kernel; `stated` is what its file says, of one step."""

    role: str
    per_step: dict[str, int]
    stated: str
    per_collision: dict[str, float]
    evaluations: float
    flops: float
    cycles: float | None
    flops_per_cycle: float | None
    refused: float


@dataclass(frozen=True)
class Sections:
    role: str
    shares: dict[str, float]
    ns: dict[str, float]  # shares of the kernel's time
    unknown: float  # share of the samples in code that no line stands for
    samples: int


@dataclass(frozen=True)
class ModelRow:
    role: str
    target: str
    cpu: str
    cycles: float | None
    bound: float | None
    uops: float | None
    ipc: float | None
    bottleneck: str
    pressure: dict[str, float]  # cycles that each of the busiest units is busy
    collision: float | None  # cycles of a mean collision, replayed
    note: str


@dataclass(frozen=True)
class MissRow:
    role: str
    source: str
    by: str
    built_for: str
    events: dict[str, float]


@dataclass(frozen=True)
class CpuCost:
    """What a kernel that one CPU's records choose takes on another, of the fastest there."""

    contest: str  # without its target
    made_for: str
    timed_on: str
    recipe: str
    cost: float | None  # None: that CPU has not timed it
    records: int  # recipes that it has timed


@dataclass(frozen=True)
class PublishedRow:
    """A row of the report (Li, Egger, Ruff, Pfingsten) beside ours, on its five cases."""

    text: str
    preset: str
    their_cycles: int | None
    their_ratio: float | None  # to their initial C
    our_cycles: float | None
    our_ratio: float | None
    note: str


@dataclass(frozen=True)
class Report:
    title: str
    scene: str
    model: str
    machine: Machine
    sweep: SweepSummary | None
    chosen: tuple[Chosen, ...]
    contests: tuple[Contest, ...]
    points: tuple[PlainPoint, ...]
    outputs: tuple[OutputErrors, ...]
    worst: tuple[Worst, ...]
    kinds: tuple[KindRow, ...]
    effects: tuple[Effect, ...]
    compilers: tuple[Effect, ...]
    growth: tuple[GrowthPoint, ...]
    growth_fits: tuple[GrowthFit, ...]
    operations: tuple[Operations, ...]
    sections: tuple[Sections, ...]
    modelled: tuple[ModelRow, ...]
    misses: tuple[MissRow, ...]
    calls: tuple[CallPoint, ...]
    published: tuple[PublishedRow, ...]
    commands: tuple[str, ...]
    missing: dict[str, str] = field(default_factory=dict)
    cpus: tuple[CpuCost, ...] = ()

    def document(self) -> dict[str, Any]:
        """As JSON can hold it: numbers that are not finite become null."""
        return {"schema": SCHEMA, **_plain(asdict(self))}


def _plain(value: Any) -> Any:
    if isinstance(value, BaseModel):
        return _plain(value.model_dump())
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else None
    return value
