"""What a run knows from its store, and what it adds: each trial is looked up before it is made."""

from __future__ import annotations

import platform
from collections import Counter
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from ..choice.trials import Depends, Final, Rejection, Run, Subject, Trial, trial_key
from ..evidence.records.code import digest
from ..registry.axes import axis
from .store import ResultStore


def now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


def _default(key: str) -> str:
    try:
        return axis(key).default
    except KeyError:
        return ""


def identity(subject: Subject) -> str:
    """What makes two records tell of the same variant, though a figure may not hold any more.

    Options at their default are left out: those of an axis that is newer than a record are, too.
    """
    options = sorted((k, code) for k, code in subject.options.items() if code != _default(k))
    return digest([subject.question, subject.stepper, options])


class Ledger:
    """The trials of a store by key, and appending to it in the name of one run.

    `fresh`: what the store has is not looked at.
    """

    def __init__(self, store: ResultStore, run: Run, fresh: bool = False) -> None:
        self._store = store
        self._run = run
        self._fresh = fresh
        self._trials: dict[str, Trial] = {}
        self._finals: dict[str, Final] = {}
        self._newest: dict[tuple[str, int], Trial] = {}
        self.made = self.reused = 0
        self.unused: Counter[str] = Counter()
        for trial in store.trials():
            self._note(trial)
        for final in store.finals():
            if not fresh:
                self._finals[final.key] = final
        store.append(run)

    def _note(self, trial: Trial) -> None:
        self._newest[identity(trial.subject), trial.rung] = trial
        if not self._fresh:
            self._trials[trial.key] = trial

    def find(self, subject: Subject, depends: Depends, rung: int) -> Trial | None:
        """The trial of an earlier run, or None; then `unused` says why one that was stored is not.

        On rung 0, as the reason is the same on all others.
        """
        found = self._trials.get(trial_key(depends, rung))
        if found is not None:
            self.reused += 1
            return found
        stale = self._newest.get((identity(subject), rung))
        if stale is not None and rung == 0:
            self.unused[self._why(stale, depends)] += 1
        return None

    def _why(self, stale: Trial, depends: Depends) -> str:
        if self._fresh:
            return "--fresh was given"
        if stale.depends is None:
            return "it was illegal then"
        parts = []
        for name in stale.depends.differences(depends):
            before, after = getattr(stale.depends, name), getattr(depends, name)
            short = name in ("compiler", "cpu", "flags", "timing", "goal", "call")
            parts.append(f"{name}: {before}, now {after}" if short else f"another {name}")
        return "; ".join(parts) or "no trial of this rung"

    def _head(self, key: str) -> dict[str, Any]:
        return {"key": key, "run": self._run.id, "made_at": now(), "machine": platform.node()}

    def trial(
        self,
        subject: Subject,
        depends: Depends,
        rung: int,
        **figures: Any,
    ) -> Trial:
        """Keep a trial; see the fields of `Trial` for the figures."""
        head = self._head(trial_key(depends, rung))
        made = Trial(**head, subject=subject, depends=depends, rung=rung, **figures).sealed()
        self._newest[identity(subject), rung] = made
        self.made += 1
        return self._kept(made)

    def refusal(self, subject: Subject, rejection: Rejection) -> None:
        """Keep, once, why a variant has no text, or no figures where it had some before."""
        key = digest(["refusal", identity(subject), rejection.model_dump()])
        if key not in self._trials:
            self._kept(Trial(**self._head(key), subject=subject, rejection=rejection).sealed())

    def _kept(self, made: Trial) -> Trial:
        self._store.append(made)
        self._trials[made.key] = made
        return made

    def find_final(self, key: str) -> Final | None:
        return self._finals.get(key)

    def final(self, key: str, **figures: Any) -> Final:
        """Keep a final; see the fields of `Final`."""
        made: Final = Final(**self._head(key), **figures).sealed()
        self._store.append(made)
        self._finals[key] = made
        return made


def new_run(
    command: str,
    seed: int,
    cpu: str,
    target: str,
    compilers: Mapping[str, str],
    cpuid: tuple[str, int, int] | None = None,
) -> Run:
    """The record of a run that begins now."""
    from .. import __version__

    head: dict[str, Any] = {"made_at": now(), "machine": platform.node(), "command": command}
    body = {**head, "seed": seed, "cpu": cpu, "target": target, "cpuid": cpuid}
    body["compilers"] = dict(compilers)
    key, system = digest(body), platform.platform()
    run: Run = Run(key=key, run=key, system=system, version=__version__, **body).sealed()
    return run
