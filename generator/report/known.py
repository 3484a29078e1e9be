"""What a report is made from: a sweep's store, what was measured beyond it, records of CPUs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from ..choice.trials import Final, Run, Trial
from ..evidence.records.evidence import Timings
from ..registry.question import DEFAULT_IMPACT
from ..sweep.store import read_only
from .contests import ContestTable, contests_of
from .findings import Findings, KernelFindings


@dataclass(frozen=True)
class Stored:
    """What a store holds of one target, scene and model; `finals` by contest, the newest."""

    runs: tuple[Run, ...] = ()
    trials: tuple[Trial, ...] = ()
    finals: dict[str, Final] = field(default_factory=dict)


@dataclass(frozen=True)
class Known:
    """All that the sections draw from."""

    target: str
    scene: str
    model: str
    cpu: str  # that was measured on, else this one
    stored: Stored = field(default_factory=Stored)
    findings: Findings | None = None
    timings: Timings = field(default_factory=Timings)
    commands: tuple[str, ...] = ()
    made_at: str = ""

    @property
    def kernels(self) -> tuple[KernelFindings, ...]:
        return self.findings.kernels if self.findings else ()

    @cached_property
    def contests(self) -> list[ContestTable]:
        return contests_of(self.stored.trials, self.stored.finals)


def last_finals(finals: Iterable[Final], target: str, scene: str, model: str) -> dict[str, Final]:
    """The newest final of each contest of a target, scene and model; re-timings do not choose."""
    prefix = _prefix(target, scene, model)
    return {
        final.contest: final
        for final in finals
        if final.contest.startswith(prefix) and final.purpose == "choice"
    }


def _prefix(target: str, scene: str, model: str) -> str:
    """With which the names of their questions and contests begin."""
    return f"{DEFAULT_IMPACT}/{target}/{scene}/{model}-"


def read_stored(place: Path, target: str, scene: str, model: str) -> Stored:
    """What a store holds of a target, scene and model. InputError where it is no store."""
    asked = (target, scene, model)
    with read_only(place) as records:
        trials = tuple(
            t for t in records.trials() if t.subject.question.startswith(_prefix(*asked))
        )
        used = {t.run for t in trials}
        runs = tuple(r for r in records.runs() if r.id in used)
        return Stored(runs, trials, last_finals(records.finals(), *asked))
