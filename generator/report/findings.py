"""What `./gen report --measure` measures beyond a sweep, and how it is kept. Plain data.

Times are in ns for one collision, errors relative to |v1 - v2| before it (R w for spins) unless a
name says otherwise. The file is JSON; `read_findings` is strict about its fields.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from ..errors import InputError
from ..evidence.records.code import SHAPING, hash_of_rooms
from ..evidence.timing.ratios import Interval, TimingResult
from ..files import write_file

SCHEMA: Literal[3] = 3
# What kernels, verdicts and counts follow from.
ROOMS = (*SHAPING, "evidence/verification", "evidence/profiling")
Source = Literal["hardware counters", "valgrind's simulation"]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="constants")


class WorstInput(_Part):
    """The case with the largest error against the exact result."""

    label: str
    error: float
    inputs: tuple[str, ...]  # the 24 numbers of a case, as hexadecimal floats
    got: tuple[str, ...]  # 12 velocities
    exact: tuple[str, ...]


class KindFindings(_Part):
    """A kind of cases through one kernel."""

    cases: int
    error: float  # largest, against the exact result
    ns: float | None
    evaluations: float  # of the rates a collision; iterations of a fixed-step kernel


class Counts(_Part):
    """Operations, counted by running the kernel with a number type that counts."""

    per_collision: dict[str, float]
    per_step: dict[str, int]  # the usual iteration, or step of an exact kernel; as its file states
    stated: str  # the text of the count in the generated file
    evaluations: float
    flops: float  # a collision, an FMA counted as two
    refused: float  # share of the iterations in which a guessed root was refused


class MissFigures(_Part):
    """Branch and cache misses a collision, and by what they were found."""

    source: Source
    by: str  # the version of valgrind, or the CPU
    built_for: str  # the target that the kernel was built for
    events: dict[str, float]


class SectionShares(_Part):
    """Shares of the samples of the program counter."""

    shares: dict[str, float]
    unknown: float
    samples: int


class Modelled(_Part):
    """llvm-mca's figures on a target: of one iteration of the loop, and of a whole collision."""

    target: str
    cpu: str
    cycles: float | None
    bound: float | None  # cycles if nothing waited for a result
    uops: float | None
    ipc: float | None
    bottleneck: str
    pressure: tuple[tuple[str, float], ...]  # cycles that the busiest units are busy
    collision: float | None  # cycles of a mean collision, replayed as it ran here
    note: str  # why there is no figure, or what was taken


class KernelFindings(_Part):
    """All that was measured of one kernel; None: not measured, `missing` says why."""

    role: str  # `paper-initial`, ..., `Euler, chosen`, `E = 1e-06, chosen`
    name: str
    steps: int | None
    budget: float | None
    timed: TimingResult | None  # in the plan that holds all kernels
    seed_cycles: float | None  # of the time stamp counter: mean over the report's five cases
    verified_error: float | None  # against what the kernel must reproduce
    error: float | None  # largest, against the exact result
    outputs: dict[str, float]  # largest error of each velocity against the exact result
    worst: WorstInput | None
    kinds: dict[str, KindFindings]
    counts: Counts | None
    sections: SectionShares | None
    misses: tuple[MissFigures, ...]
    modelled: tuple[Modelled, ...]
    missing: dict[str, str]


class GrowthPoint(_Part):
    """A kernel's time and error with another number of steps."""

    role: str
    steps: int
    ns: float
    error: float  # largest, against the exact result
    slipping_error: float  # the same without contacts that stick


class CallPoint(_Part):
    """A kernel through carom_collide or carom_collide_batch, against the scalar call."""

    role: str
    kernel: str
    width: int
    call: Literal["scalar", "batch"]
    timed: TimingResult  # its ratio is to the scalar call of the same goal


class Findings(_Part):
    """The file."""

    schema_version: Literal[3] = SCHEMA
    made_at: str
    sources: str  # `sources_hash` then: what the kernels and their figures follow from
    command: str
    cpu: str
    target: str
    scene: str
    model: str
    compilers: dict[str, str]
    flags: dict[str, str]  # by role
    seeds: dict[str, int]
    tsc_ghz: float
    control: Interval  # ratios that the baseline has to itself
    rounds: int
    timing_cases: int
    verified_cases: int
    kernels: tuple[KernelFindings, ...]
    growth: tuple[GrowthPoint, ...]
    calls: tuple[CallPoint, ...]

    def find(self, role: str) -> KernelFindings | None:
        return next((k for k in self.kernels if k.role == role), None)


@cache
def sources_hash() -> str:
    """Hash of the rooms and templates that kernels, verdicts and counts follow from."""
    return hash_of_rooms(ROOMS)[:16]


def findings_path(cache: Path, target: str, scene: str, model: str) -> Path:
    return cache / "report" / f"{target}.{scene}.{model}.json"


def write_findings(path: Path, findings: Findings) -> None:
    write_file(path, findings.model_dump_json(indent=1) + "\n", parents=True)


def read_findings(path: Path) -> Findings | None:
    """What was measured before; None where nothing was. InputError where it does not read."""
    if not path.exists():
        return None
    try:
        return Findings(**json.loads(path.read_text("utf-8")))
    except (OSError, ValueError, TypeError) as error:
        first = error.errors()[0] if isinstance(error, ValidationError) else None
        where = ".".join(str(part) for part in first["loc"]) if first else "(file)"
        reason = first["msg"] if first else str(error)
        raise InputError(
            f"{path}: {where}: {reason}; make it anew with ./gen report --measure"
        ) from None
