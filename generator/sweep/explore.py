"""One contest of a sweep: waves of variants built side by side, then timed one by one."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from ..choice.workbench import Candidate
from ..errors import EmissionError, KernelError
from ..evidence.timing.ratios import timing_run
from ..registry.names import name_of
from ..registry.variant import Variant
from .figures import errors_of, times_of
from .lab import Lab
from .ladder import RUNGS, Entry, by_ratio, eligible, promoted
from .ledger import Ledger
from .record import Depends, Rejection, Trial
from .search import Search
from .sources import candidate_hash
from .space import Contest
from .station import BLOCK_MS, TimingJob, one_line, rejection_of

WAVE = 8
_CANDIDATES = 256  # that are kept in memory, each with its text
TRIAL_SECONDS = 8.0  # a timing ends then, whatever its rounds; half of it may be waiting


@dataclass(frozen=True)
class Budget:
    """When to stop: a time of the monotonic clock, or a number of new trials, or both."""

    deadline: float | None
    trials: int | None

    def over(self, made: int) -> bool:
        late = self.deadline is not None and time.monotonic() >= self.deadline
        return late or (self.trials is not None and made >= self.trials)


@dataclass(frozen=True)
class Progress:
    """What a display may show, after each trial and each step of the work."""

    contest: Contest
    doing: str
    tried: int
    reused: int
    rejected: int
    best: str
    best_ratio: float | None


Observer = Callable[[Progress], None]


@dataclass
class Exploration:
    """The entries of a contest, by name of the variant, and how they came about."""

    contest: Contest
    search: Search
    baseline: Candidate  # built and verified
    lab: Lab
    ledger: Ledger
    budget: Budget
    observe: Observer
    entries: dict[str, Entry] = field(default_factory=dict)
    rejected: Counter[str] = field(default_factory=Counter)
    tried: int = 0  # new trials on the lowest rung
    complete: bool = False  # the search had nothing left to propose
    _candidates: dict[str, Candidate] = field(default_factory=dict)
    _best: Entry | None = None

    def __post_init__(self) -> None:
        self._baseline_hash = candidate_hash(self.baseline)

    def run(self) -> None:
        """Waves until the search has nothing left or the budget is used up."""
        while not self.complete and not self.budget.over(self.tried):
            self.wave()

    def wave(self) -> None:
        """One wave, up all rungs; where the search has nothing left, it is complete."""
        timed = [(e.variant, e.ratio) for e in self.ranked()]
        rejected = [e.variant for e in self.entries.values() if e.last.rejection is not None]
        wave = self.search.next_wave(WAVE, timed, rejected)
        self.complete = not wave
        self._first_rung(wave)
        for rung in range(len(RUNGS) - 1):
            self._next_rung(promoted(list(self.entries.values()), rung))

    @property
    def untried(self) -> bool:
        """Did the budget end before the first variant?"""
        return not self.entries and not self.rejected

    def ranked(self) -> list[Entry]:
        """What may be chosen, fastest first."""
        return by_ratio(list(self.entries.values()))

    def built(self, entries: Sequence[Entry]) -> list[tuple[Entry, Candidate]]:
        """Those with a library, which is made again where it was lost; what fails now is out."""
        candidates = [self._candidate(e.variant) for e in entries]
        lost: set[str] = set()
        for candidate, rejection in self.lab.build([c for c in candidates if c.library is None]):
            if rejection is not None:
                lost.add(candidate.name)
                self.drop(candidate.variant, rejection)
        pairs = zip(entries, candidates, strict=True)
        return [(entry, candidate) for entry, candidate in pairs if candidate.name not in lost]

    def drop(self, variant: Variant, why: Rejection) -> None:
        """An entry that had figures and fails now is out of this run."""
        gone = self.entries.pop(name_of(variant), None)
        if gone is self._best:
            self._best = next(iter(self.ranked()), None)
        self._refuse(variant, why)

    def still_holds(self, entry: Entry) -> bool:
        """Does what the figures of an entry depend on stand as it did?"""
        now = self._depends(entry.variant, entry.last.rung)
        return entry.last.depends == now

    def note_constraints(self, variant: Variant) -> None:
        """Keep why the illegal ones of all that are one option from a variant are illegal."""
        for other in self.search.space.steps_from(variant):
            rule = self.search.space.broken(other)
            if rule is not None:
                why = Rejection(reason="constraint", text=f"{rule.name}: {rule.reason}")
                self._refuse(other, why)

    def tell(self, doing: str) -> None:
        best = self._best
        self.observe(
            Progress(
                contest=self.contest,
                doing=doing,
                tried=self.tried,
                reused=self.ledger.reused,
                rejected=sum(n for why, n in self.rejected.items() if why != "constraint"),
                best=best.last.subject.name if best else "",
                best_ratio=best.ratio if best else None,
            )
        )

    # -- one wave --

    def _first_rung(self, wave: Sequence[Variant]) -> None:
        new: list[Candidate] = []
        for variant in wave:
            self.tell("emitting")
            try:
                found = self._found(variant, 0)
                if found is None:
                    new.append(self._candidate(variant))
            except EmissionError as error:
                self._refuse(variant, Rejection(reason="compile", text=one_line(str(error))))
                continue
            if found is not None:
                self._enter(variant, found)
        if self.budget.trials is not None:
            new = new[: self.budget.trials - self.tried]
        self._try(new)

    def _try(self, new: Sequence[Candidate]) -> None:
        ready: set[str] = set()
        self.tell(f"building {len(new)}")
        for candidate, rejection in self.lab.build(new):
            if rejection is None:
                ready.add(candidate.name)
            else:
                self._keep(candidate, 0, rejection=rejection)
            self.tell("building")
        for candidate in new:  # in their order, not in that of the compiler
            if candidate.name in ready:
                self._time(candidate, 0)
                self.tell("timing")

    def _next_rung(self, entries: Sequence[Entry]) -> None:
        missing = []
        for entry in entries:
            found = self._found(entry.variant, entry.rung + 1)
            if found is None:
                missing.append(entry)
            else:
                self._enter(entry.variant, found)
        for entry, candidate in self.built(missing):
            self.tell(f"timing for longer ({RUNGS[entry.rung + 1]} rounds)")
            self._time(candidate, entry.rung + 1)

    def _time(self, candidate: Candidate, rung: int) -> None:
        kernels = {c.name: c for c in (self.baseline, candidate)}
        job = TimingJob(tuple(kernels.values()), RUNGS[rung], TRIAL_SECONDS)
        try:
            run = timing_run(self.lab.time(job))
        except KernelError as error:
            self._keep(candidate, rung, rejection=rejection_of(error))
        else:
            self._keep(candidate, rung, times=times_of(run, candidate.name))

    # -- records --

    def _candidate(self, variant: Variant) -> Candidate:
        name = name_of(variant)
        if name not in self._candidates:
            if len(self._candidates) >= _CANDIDATES:  # the oldest: it can be made again
                del self._candidates[next(iter(self._candidates))]
            self._candidates[name] = self.lab.candidate(variant)
        return self._candidates[name]

    def _depends(self, variant: Variant, rung: int) -> Depends:
        code = self.lab.code(variant)
        rules = self.lab.rules(variant.stepper.steps, variant.width > 1)
        return Depends(
            source=code.source,
            compiler=code.compiler,
            flags=code.flags,
            cpu=self.lab.cpu,
            goal=str(variant.stepper.goal),
            call=self.contest.call,
            cases=rules.cases,
            rules=rules.rules,
            bench=rules.bench,
            baseline=self._baseline_hash,
            timing=f"{RUNGS[rung]} rounds, blocks of {BLOCK_MS:g} ms",
            timed=rules.timed,
        )

    def _found(self, variant: Variant, rung: int) -> Trial | None:
        subject = self.contest.subject(variant)
        return self.ledger.find(subject, self._depends(variant, rung), rung)

    def _keep(self, candidate: Candidate, rung: int, **figures: object) -> None:
        library = candidate.library
        trial = self.ledger.trial(
            self.contest.subject(candidate.variant),
            self._depends(candidate.variant, rung),
            rung,
            build_seconds=None if library is None or library.hit else round(library.seconds, 3),
            errors=errors_of(candidate),
            **figures,
        )
        self.tried += rung == 0
        self._enter(candidate.variant, trial)

    def _refuse(self, variant: Variant, why: Rejection) -> None:
        self.rejected[why.reason] += 1
        self.ledger.refusal(self.contest.subject(variant), why)

    def _enter(self, variant: Variant, trial: Trial) -> None:
        entry = self.entries.setdefault(name_of(variant), Entry(variant))
        entry.trials.append(trial)
        if entry is self._best:  # a longer timing may say that it is not
            self._best = next(iter(self.ranked()), None)
        elif eligible(entry) and (self._best is None or entry.ratio < self._best.ratio):
            self._best = entry
        rejection: Rejection | None = trial.rejection
        if rejection is not None:
            self.rejected[rejection.reason] += 1
