"""The contests of a CPU timed anew, and its records written: each timing is kept at once."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path

from ..evidence.records.files import read_records, write_records
from .explore import Observer
from .exporting import exported
from .lab import Lab
from .ledger import Ledger
from .record import Run
from .space import Contest
from .store import ResultStore
from .sweep import Outcome, Plan, run_sweep

LabOf = Callable[[str], AbstractContextManager[Lab]]  # by contact model
RunOf = Callable[[Lab], Run]


def refresh(
    plan: Plan,
    models: Sequence[str],
    lab_of: LabOf,
    store: ResultStore,
    run_of: RunOf,
    out: Path,
    observe: Observer,
    say: Callable[[str], None],
) -> list[Outcome]:
    """Each contact model with its share of the minutes; the records are written after each.

    `plan`: of one model; its minutes are those of all.
    """
    started, outcomes = time.monotonic(), []
    for number, model in enumerate(models):
        left = None
        if plan.minutes is not None:
            left = max(0.0, plan.minutes - (time.monotonic() - started) / 60) / (
                len(models) - number
            )
        contests = tuple(replace(contest, model=model) for contest in plan.contests)
        with lab_of(model) as lab:
            asked = replace(plan, contests=contests, minutes=left, compilers=tuple(lab.compilers))
            ledger = Ledger(store, run_of(lab))
            outcomes += run_sweep(asked, lab, ledger, observe, time.monotonic())
        say(f"{model}: {add_exported(store, plan.target.name, out, say)}")
    return outcomes


def add_exported(store: ResultStore, target: str, out: Path, say: Callable[[str], None]) -> str:
    """What a store has of a CPU put into a file of records, new or there already."""
    known = read_records(out) if out.exists() else None
    found = exported(store, target)
    for line in (*(known.damaged if known else ()), *found.left):
        say(line)
    before = len(known.records) if known else 0
    after = write_records(out, (*(known.records if known else ()), *found.records))
    return f"{len(found.records)} records, {after - before} of them new; written: {out}"


def contests_of(
    target: str, scene: str, steps: int, budgets: Sequence[float]
) -> tuple[Contest, ...]:
    """Single calls and batches, of fixed steps and of each budget; the model comes later."""
    goals: list[tuple[int | None, float | None]] = [(steps, None), *((None, b) for b in budgets)]
    return tuple(
        Contest(target, scene, "", *goal, call) for call in ("scalar", "batch") for goal in goals
    )
