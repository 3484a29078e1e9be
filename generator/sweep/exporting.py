"""Records of timings out of a store: of each kernel's code the timing that tells most."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from ..choice.trials import Depends, Final, Run, Times, Trial
from ..evidence.records.record import Basis, Cpu, TimingRecord
from ..evidence.timing.ratios import Speed
from ..targets.host import KNOWN_CPUS
from .ledger import identity
from .store import ResultStore


@dataclass(frozen=True)
class Exported:
    """Records, and a line for each trial of which there is none."""

    records: tuple[TimingRecord, ...]
    left: tuple[str, ...]


@dataclass(frozen=True)
class _Timed:
    """The times of a trial, or of the final that its kernel was in later."""

    trial: Trial
    depends: Depends
    times: Times
    made_at: str
    origin: str


def exported(store: ResultStore, target: str) -> Exported:
    """The records of a target's CPU in a store."""
    runs = {run.id: run for run in store.runs()}
    records, left = [], []
    for timed in _with_finals(_longest(store.trials(), target), store.finals()):
        try:
            records.append(_record(timed, runs[timed.trial.run]))
        except ValueError as error:
            left.append(f"{timed.trial.subject.name}: {error}; the trial is skipped")
    return Exported(tuple(records), tuple(left))


def _longest(trials: Iterable[Trial], target: str) -> list[_Timed]:
    """Of each variant's code the trial of the highest rung."""
    found: dict[tuple[str, Depends], _Timed] = {}
    for t in trials:
        if t.times is None or t.depends is None or t.subject.asked.target != target:
            continue
        key = (identity(t.subject), t.depends.model_copy(update={"timing": ""}))
        if key not in found or found[key].trial.rung <= t.rung:
            found[key] = _Timed(t, t.depends, t.times, t.made_at, f"sweep, rung {t.rung}")
    return list(found.values())


def _with_finals(longest: Iterable[_Timed], finals: Iterable[Final]) -> Iterator[_Timed]:
    """A final timed what was newest then."""
    known = sorted(longest, key=lambda timed: timed.made_at)
    found = {timed.trial.id: timed for timed in known}
    for final in finals:
        newest = {identity(t.trial.subject): t for t in known if t.made_at <= final.made_at}
        for row in final.finalists:
            timed = newest.get(identity(row.subject))
            if timed is not None:
                origin = f"sweep, final of {len(final.finalists)}, {final.processes} processes"
                found[timed.trial.id] = replace(
                    timed, times=row.times, made_at=final.made_at, origin=origin
                )
    yield from found.values()


def _record(timed: _Timed, run: Run) -> TimingRecord:
    variant = timed.trial.subject.variant()
    return TimingRecord(
        question=str(variant.question),
        recipe=str(variant.recipe),
        **timed.times.model_dump(include=set(Speed.model_fields)),
        control=timed.times.control,
        rounds=timed.times.rounds,
        when=timed.made_at[:19] + "Z",
        origin=timed.origin,
        cpu=cpu_of(run),
        basis=Basis(**timed.depends.model_dump(include=set(Basis.model_fields))),
    )


def cpu_of(run: Run) -> Cpu:
    """The CPU of a run; where it was not noted, what is known of the target."""
    target, _, name = run.cpu.partition(", ")
    vendor, family, model = run.cpuid or ("", 0, None)
    for row in KNOWN_CPUS:
        if run.cpuid is None and row.target == target:
            vendor, family = row.vendor, row.family
    return Cpu(target=target, name=name, vendor=vendor, family=family, model=model)
