"""`--verify-choice`: the choice of an earlier sweep timed again against the next best."""

from __future__ import annotations

from ..choice.trials import Final, Trial
from ..errors import InputError
from .explore import Exploration
from .finals import hold
from .ladder import Entry, by_ratio
from .ledger import identity
from .store import ResultStore

ROUNDS = 150  # in each process


def verify_choice(
    exploration: Exploration, store: ResultStore, best: int, rivals: ResultStore | None = None
) -> Final:
    """The choice and the next `best - 1` of all that the store and that of rivals has, interleaved.

    Raises InputError where the store has no choice for the contest.
    """
    contest = str(exploration.contest)
    finals = [f for f in store.finals() if f.contest == contest and f.purpose == "choice"]
    if not finals:
        raise InputError(f"{store.path}: no choice for {contest}; run ./gen sweep first")
    last = finals[-1]
    entries = stored_entries(store, contest)
    if rivals is not None:
        entries = stored_entries(rivals, contest) | entries
    chosen = entries[identity(last.row(last.chosen).subject)]
    picked = [chosen]
    for entry in by_ratio(list(entries.values())):
        if len(picked) == best:
            break
        if entry is not chosen and exploration.still_holds(entry):
            picked.append(entry)
    return hold(exploration, picked, "verify-choice", ROUNDS, chosen.last.subject.name)


def stored_entries(store: ResultStore, contest: str) -> dict[str, Entry]:
    """Every variant of a contest with its newest trials, rung by rung, by identity."""
    newest: dict[str, dict[int, Trial]] = {}
    for trial in store.trials():
        reason = trial.rejection.reason if trial.rejection else ""
        if trial.subject.contest == contest and reason != "constraint":
            newest.setdefault(identity(trial.subject), {})[trial.rung] = trial
    entries = {}
    for key, by_rung in newest.items():
        try:
            variant = by_rung[min(by_rung)].subject.variant()
        except ValueError:
            continue  # an option that the registry no longer has
        entries[key] = Entry(variant, [by_rung[rung] for rung in sorted(by_rung)])
    return entries
