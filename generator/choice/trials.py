"""The records of contests: what was tried, on what it depends, what came out. See docs/sweep.md.

Field names and meanings are the stored format. A record is never changed; a new measurement is a
new record. `SCHEMA` counts up when a field changes its meaning.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from ..errors import KernelError
from ..evidence.records.code import digest
from ..evidence.records.record import Basis
from ..evidence.timing.ratios import Speed, TimingRun, control_band, timing_results, to_digits
from ..registry.question import Call, Goal, Question, read_question
from ..registry.variant import Variant, answered
from .kernel import Code, Emitted, Reason, Rejected, verdict_of

SCHEMA: Literal[4] = 4
_DIGITS = 5


def rounded(value: float) -> float:
    """To as many digits as records keep."""
    return to_digits(value, _DIGITS)


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def one_line(text: str) -> str:
    return " ".join(text.split())


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Depends(Basis):
    """All that a figure depends on, its time and more: with the rung, the key of a trial."""

    cpu: str  # the target name and the model name of the CPU that timed
    goal: str  # of the name grammar: n1000, e1m06
    call: Call
    answers: str  # hash of the cases that are verified on, and of what must come out
    rules: str  # hash of the rules of verification
    timing: str  # how a trial is timed: rounds and length of a block

    def differences(self, other: Depends) -> tuple[str, ...]:
        """Names of the fields in which two differ."""
        return tuple(k for k in type(self).model_fields if getattr(self, k) != getattr(other, k))


@dataclass(frozen=True)
class Rules:
    """What all figures of a contest depend on besides the kernel; see `Depends`."""

    cpu: str
    call: Call
    cases: str
    answers: str
    rules: str
    bench: str

    def depends(self, code: Code, goal: Goal, baseline: Code, timing: str = "") -> Depends:
        """What the figures of a kernel depend on."""
        return Depends(
            source=code.source,
            compiler=code.compiler,
            flags=" ".join(code.flags),
            baseline=baseline.hash,
            goal=str(goal),
            timing=timing,
            **vars(self),
        )


class Subject(_Part):
    """The variant, as the registry knew it when the record was made."""

    question: str
    recipe: str
    options: dict[str, str]  # of every axis, those at their default too

    @staticmethod
    def of(variant: Variant) -> Subject:
        question, recipe = str(variant.question), str(variant.recipe)
        return Subject(question=question, recipe=recipe, options=dict(variant.options))

    @property
    def name(self) -> str:
        return f"{self.question} {self.recipe}"

    @property
    def stepper(self) -> str:
        return self.recipe.split()[0]

    @property
    def contest(self) -> str:
        """The variants that one choice is made among share it: as a contest is written."""
        held, _, width = self.question.rpartition("-")
        return f"{held}-{'scalar' if width == 'x1' else 'batch'}"

    @cached_property
    def asked(self) -> Question:
        """The question. Raises ValueError where a name of it is gone."""
        return read_question(self.question)

    def variant(self) -> Variant:
        """The variant that the record was made of, in today's registry.

        Axes that are newer have their default. Raises ValueError where an option is gone.
        """
        return answered(self.asked, self.stepper, self.options)


class Errors(_Part):
    """What verification found; None where a kernel ended before it gave any result."""

    passed: bool
    reason: str
    max_abs_error: float | None  # m/s
    max_rel_error: float | None  # of |v1 - v2| before
    against: Literal["exact", "euler"]
    cases: int
    flips: int
    worst_case: int | None  # row of the cases
    max_flip_error: float  # m/s
    sticking: int
    max_sticking_rel_error: float

    @staticmethod
    def of(kernel: Emitted | Rejected) -> Errors | None:
        """Those of a kernel that came so far."""
        verdict = verdict_of(kernel)
        if verdict is None:
            return None
        rejected = kernel.text if isinstance(kernel, Rejected) else ""
        return Errors(
            passed=not rejected,
            reason=one_line(rejected or verdict.reason),
            max_abs_error=_known(verdict.max_abs_error),
            max_rel_error=_known(verdict.max_rel_error),
            against="euler" if kernel.variant.stepper.family == "fixed" else "exact",
            cases=verdict.cases,
            flips=len(verdict.flips),
            worst_case=verdict.worst_case,
            max_flip_error=verdict.max_flip_error,
            sticking=verdict.sticking,
            max_sticking_rel_error=verdict.max_sticking_rel_error,
        )


class Times(Speed, _Part):
    """What timing found, against `paper-initial` in the same rounds."""

    cycles: float  # of the time stamp counter
    control: tuple[float, float]  # A/A band: ratios that the baseline has to itself
    baseline_ns: float
    rounds: int
    ratios: tuple[float, ...]  # of each round
    quiet: float | None = None  # share of these rounds with the core alone; None: not looked at

    @staticmethod
    def of(run: TimingRun, name: str) -> Times:
        """What a timing says of a kernel, against the baseline in the same rounds."""
        result = next(r for r in timing_results(run) if r.name == name)
        base = run.throughput.ns[run.baseline]
        control = control_band(run)
        return Times(
            **result.rounded(_DIGITS),
            cycles=rounded(result.cycles),
            control=(rounded(control[0]), rounded(control[1])),
            baseline_ns=rounded(float(np.median(base))),
            rounds=run.rounds,
            quiet=rounded(run.quiet),
            ratios=tuple(rounded(float(r)) for r in run.throughput.ns[name] / base),
        )


class Rejection(_Part):
    """Why a variant ended without a time."""

    reason: Reason
    text: str  # one line

    @staticmethod
    def of(rejected: Rejected) -> Rejection:
        return Rejection(reason=rejected.reason, text=one_line(rejected.text))


class Record(_Part):
    """What all records have. `id` is the hash of the rest, so merging stores is a union."""

    schema_version: Literal[4] = SCHEMA
    id: str = ""
    key: str  # the same question has the same key
    run: str  # id of the run that made it
    made_at: str  # UTC, ISO 8601
    machine: str  # host name

    def sealed(self) -> Any:
        """The record with its id."""
        body = self.model_dump(mode="json", exclude={"id"})
        return self.model_copy(update={"id": digest(body)})


class Run(Record):
    """One `./gen sweep`: what was asked, and the machine."""

    kind: Literal["run"] = "run"
    command: str
    seed: int
    cpu: str
    cpuid: tuple[str, int, int] | None = None  # vendor, family, model; None: not noted
    target: str
    compilers: dict[str, str]  # axis code: first line of --version
    system: str
    version: str  # of carom


class Trial(Record):
    """A variant at one rung: built, verified, timed; or rejected."""

    kind: Literal["trial"] = "trial"
    subject: Subject
    depends: Depends | None = None  # None for a constraint: there is no source
    rung: int = 0  # 0 is the shortest timing
    rejection: Rejection | None = None
    build_seconds: float | None = None
    errors: Errors | None = None
    times: Times | None = None


class Finalist(_Part):
    """A kernel in a final. Ratios are to the baseline, and to the fastest, in the same rounds."""

    subject: Subject
    times: Times
    to_fastest: float  # median over the processes
    to_fastest_ci: tuple[float, float]  # their range
    distance: int  # options away from the default
    max_rel_error: float | None
    tie: bool  # with the fastest


class Final(Record):
    """The best of a contest, all interleaved, in several processes: this decides."""

    kind: Literal["final"] = "final"
    contest: str  # its name
    purpose: Literal["choice", "verify-choice"]
    chosen: str  # of the ties within 1 %, the one with the fewest options from the default
    fastest: str
    finalists: tuple[Finalist, ...]  # fastest first
    rounds: int  # of all processes together
    processes: int
    control: tuple[float, float]

    @property
    def ties(self) -> tuple[str, ...]:
        """Names of the kernels that cannot be told from the fastest, itself included."""
        return tuple(f.subject.name for f in self.finalists if f.tie)

    def row(self, name: str) -> Finalist:
        """A finalist by the name it had then. KernelError where it was none."""
        for row in self.finalists:
            if row.subject.name == name:
                return row
        raise KernelError(f"{name} was not timed in this final")


AnyRecord = Annotated[Run | Trial | Final, Field(discriminator="kind")]
_ADAPTER: TypeAdapter[Run | Trial | Final] = TypeAdapter(AnyRecord)


def trial_key(depends: Depends, rung: int) -> str:
    """The key of a trial: nothing of its name, nothing of other variants."""
    return digest([SCHEMA, rung, depends.model_dump(mode="json")])


def job_key(purpose: object, depends: Iterable[Depends]) -> str:
    """The key of kernels that are timed together, in any order."""
    return digest([SCHEMA, purpose, sorted(each.model_dump_json() for each in depends)])


def parse_record(text: str) -> Run | Trial | Final:
    """A stored record. Raises ValueError (pydantic's) where a field is missing or wrong."""
    return _ADAPTER.validate_json(text)
