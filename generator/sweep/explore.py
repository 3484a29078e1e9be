"""One contest of a sweep: waves of variants built side by side, then timed one by one."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from ..choice.kernel import Built, Emitted, Rejected, Verified
from ..choice.timing import ended_by
from ..choice.trials import Depends, Errors, Rejection, Subject, Times, Trial, one_line
from ..choice.workbench import BLOCK_MS, TimingJob
from ..errors import EmissionError, KernelError
from ..evidence.timing.ratios import timing_run
from ..registry.names import name_of
from ..registry.question import Contest
from ..registry.variant import Variant
from .lab import Lab
from .ladder import RUNGS, Entry, by_ratio, eligible, promoted
from .ledger import Ledger
from .search import Search

WAVE = 8
_KERNELS = 256  # that are kept in memory, each with its text
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
Stage = TypeVar("Stage", bound=Emitted)


@dataclass
class Exploration:
    """The entries of a contest, by name of the variant, and how they came about."""

    contest: Contest
    search: Search
    baseline: Verified
    lab: Lab
    ledger: Ledger
    budget: Budget
    observe: Observer
    entries: dict[str, Entry] = field(default_factory=dict)
    rejected: Counter[str] = field(default_factory=Counter)
    tried: int = 0  # new trials on the lowest rung
    complete: bool = False  # the search had nothing left to propose
    _kernels: dict[str, Emitted] = field(default_factory=dict)
    _best: Entry | None = None

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

    def built(self, entries: Sequence[Entry]) -> list[tuple[Entry, Verified]]:
        """Those with a library, which is made again where it was lost; what fails now is out."""
        kernels = [self._kernel(e.variant) for e in entries]
        there = {k.name: k for k in kernels if isinstance(k, Verified)}
        for kernel, made in self.lab.build([k for k in kernels if k.name not in there]):
            if isinstance(made, Rejected):
                self.drop(kernel.variant, Rejection.of(made))
            else:
                there[made.name] = self._remember(made)
        pairs = zip(entries, kernels, strict=True)
        return [(entry, there[k.name]) for entry, k in pairs if k.name in there]

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
        new: list[Emitted] = []
        for variant in wave:
            self.tell("emitting")
            try:
                found = self._found(variant, 0)
                if found is None:
                    new.append(self._kernel(variant))
            except EmissionError as error:
                self._refuse(variant, Rejection(reason="compile", text=one_line(str(error))))
                continue
            if found is not None:
                self._enter(variant, found)
        if self.budget.trials is not None:
            new = new[: self.budget.trials - self.tried]
        self._try(new)

    def _try(self, new: Sequence[Emitted]) -> None:
        ready: dict[str, Verified] = {}
        self.tell(f"building {len(new)}")
        for kernel, made in self.lab.build(new):
            if isinstance(made, Rejected):
                self._keep(made, 0)
            else:
                ready[kernel.name] = self._remember(made)
            self.tell("building")
        for kernel in new:  # in their order, not in that of the compiler
            if kernel.name in ready:
                self._time(ready[kernel.name], 0)
                self.tell("timing")

    def _next_rung(self, entries: Sequence[Entry]) -> None:
        missing = []
        for entry in entries:
            found = self._found(entry.variant, entry.rung + 1)
            if found is None:
                missing.append(entry)
            else:
                self._enter(entry.variant, found)
        for entry, kernel in self.built(missing):
            self.tell(f"timing for longer ({RUNGS[entry.rung + 1]} rounds)")
            self._time(kernel, entry.rung + 1)

    def _time(self, kernel: Verified, rung: int) -> None:
        kernels = {k.name: k for k in (self.baseline, kernel)}
        job = TimingJob(tuple(kernels.values()), RUNGS[rung], TRIAL_SECONDS)
        try:
            run = timing_run(self.lab.time(job))
        except KernelError as error:
            self._keep(ended_by(kernel, error), rung)
        else:
            self._keep(kernel, rung, Times.of(run, kernel.name))

    # -- records --

    def _kernel(self, variant: Variant) -> Emitted:
        known = self._kernels.get(name_of(variant))
        return known if known is not None else self._remember(self.lab.emit(variant))

    def _remember(self, kernel: Stage) -> Stage:
        if kernel.name not in self._kernels and len(self._kernels) >= _KERNELS:
            del self._kernels[next(iter(self._kernels))]  # the oldest: it can be made again
        self._kernels[kernel.name] = kernel
        return kernel

    def depends(self, variant: Variant, timing: str) -> Depends:
        """What figures of a variant depend on, by a way of timing."""
        code, goal = self.lab.code(variant), variant.question.goal
        return self.lab.rules(self.contest).depends(code, goal, self.baseline.code, timing)

    def _depends(self, variant: Variant, rung: int) -> Depends:
        return self.depends(variant, f"{RUNGS[rung]} rounds, blocks of {BLOCK_MS:g} ms")

    def _found(self, variant: Variant, rung: int) -> Trial | None:
        subject = Subject.of(variant)
        return self.ledger.find(subject, self._depends(variant, rung), rung)

    def _keep(self, made: Verified | Rejected, rung: int, times: Times | None = None) -> None:
        known, seconds = made.emitted, None
        if isinstance(known, Built) and not known.library.hit:
            seconds = round(known.library.seconds, 3)
        trial = self.ledger.trial(
            Subject.of(made.variant),
            self._depends(made.variant, rung),
            rung,
            build_seconds=seconds,
            errors=Errors.of(made),
            rejection=Rejection.of(made) if isinstance(made, Rejected) else None,
            times=times,
        )
        self.tried += rung == 0
        self._enter(made.variant, trial)

    def _refuse(self, variant: Variant, why: Rejection) -> None:
        self.rejected[why.reason] += 1
        self.ledger.refusal(Subject.of(variant), why)

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
