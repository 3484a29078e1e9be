"""The contests of a CPU timed anew, and its records written: each timing is kept at once."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from ..evidence.records.files import read_records, write_records
from ..registry.question import CALLS, DEFAULT_IMPACT, Contest, Goal
from .explore import Observer
from .exporting import exported
from .lab import Lab
from .ledger import Ledger
from .store import ResultStore
from .sweep import Outcome, Plan, run_sweep


def refresh(
    plan: Plan,
    models: Sequence[str],
    lab: Lab,
    ledger: Ledger,
    observe: Observer,
    after: Callable[[str], None],
) -> list[Outcome]:
    """Each contact model with its share of the minutes; `after` is called with each when done.

    `plan`: of one model; its minutes are those of all.
    """
    started, outcomes = time.monotonic(), []
    for number, model in enumerate(models):
        left = None
        if plan.minutes is not None:
            used = (time.monotonic() - started) / 60
            left = max(0.0, plan.minutes - used) / (len(models) - number)
        contests = tuple(replace(contest, model=model) for contest in plan.contests)
        asked = replace(plan, contests=contests, minutes=left)
        outcomes += run_sweep(asked, lab, ledger, observe, time.monotonic())
        after(model)
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
    goals = [Goal(steps=steps), *(Goal(budget=budget) for budget in budgets)]
    return tuple(
        Contest(DEFAULT_IMPACT, target, scene, "", goal, call) for call in CALLS for goal in goals
    )
