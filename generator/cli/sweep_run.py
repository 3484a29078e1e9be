"""What gen sweep does with its options."""

from __future__ import annotations

import shlex
import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from ..choice.folder import checked_selection, require_writable
from ..choice.job import STEPS
from ..errors import InputError
from ..evidence.records.evidence import read_timings
from ..impacts.ball_ball.models import find_model
from ..impacts.ball_ball.scene import find_scene
from ..places import cache_folder
from ..registry.lane_numbers import widths_for
from ..steppers.exact.budgets import plan_for
from ..sweep.lab import Lab, LocalLab
from ..sweep.ledger import Ledger, new_run
from ..sweep.recheck import verify_choice
from ..sweep.selecting import write_choices
from ..sweep.space import Contest, parse_only
from ..sweep.station import Station
from ..sweep.store import ResultStore, default_store, opened, read_only
from ..sweep.sweep import USEFUL_MINUTES, Plan, explorations, require_spaces, run_sweep
from ..targets.host import read_host
from ..targets.target import Target
from .cluster import connected
from .interrupts import kept
from .session import RECORDED, ROOT, resolve_target, workbench
from .sweep_display import SweepDisplay, displayed, say_outcomes, say_verified


@dataclass(frozen=True)
class Asked:
    """The options of the command, as given."""

    target: str
    scene: str
    model: str | None
    steps: int | None
    max_error: float | None
    call: str | None
    only: tuple[str, ...]
    minutes: float | None
    trials: int | None
    exhaustive: bool
    seed: int
    store: Path | None
    fresh: bool
    write: bool
    out: Path | None
    verify_choice: bool
    rivals: Path | None
    best: int
    scheduler: str | None
    wait: float

    @property
    def place(self) -> Path:
        """The store that is used."""
        return self.store or default_store(cache_folder())


def run(asked: Asked) -> int:
    """Explore and choose, or verify a choice; the command's exit status."""
    started = time.monotonic()
    target = _target(asked)
    scene = find_scene(asked.scene)
    model = find_model(asked.model or scene.model).name
    contests = _contests(asked, target, model, scene.max_error)
    only = parse_only(asked.only)
    _require_places(asked)
    with _lab(asked, target, model) as lab:
        plan = _plan(asked, target, contests, only, lab)
        require_spaces(plan)
        try:
            with opened(asked.place) as store:
                return _work(asked, plan, lab, store, started)
        except KeyboardInterrupt:
            _say_stopped(asked)
            raise


def _plan(
    asked: Asked,
    target: Target,
    contests: Sequence[Contest],
    only: Mapping[str, tuple[str, ...]],
    lab: Lab,
) -> Plan:
    widths = {
        "scalar": (1,),
        "batch": tuple(w for w in widths_for(target, asked.scene, "exact") if w > 1),
    }
    return Plan(
        target=target,
        contests=tuple(c for c in contests if widths[c.call]),
        widths=widths,
        only=only,
        compilers=tuple(lab.compilers),
        seed=asked.seed,
        exhaustive=asked.exhaustive,
        minutes=asked.minutes,
        trials=asked.trials,
        timings=read_timings(RECORDED, lambda line: Console(stderr=True).print(f"carom: {line}")),
    )


def _work(asked: Asked, plan: Plan, lab: Lab, store: ResultStore, started: float) -> int:
    command = " ".join(["./gen", *map(shlex.quote, sys.argv[1:])])
    cpuid = read_host().cpuid if asked.scheduler is None else None
    record = new_run(command, plan.seed, lab.cpu, plan.target.name, lab.compilers, cpuid)
    ledger = Ledger(store, record, asked.fresh)
    end = None if plan.minutes is None else started + 60 * plan.minutes
    console = Console()
    say_too_short(plan)
    display = SweepDisplay(started, end, plan.trials)
    with displayed(display, Console(stderr=True)) as show, kept(show) as observe:
        if asked.verify_choice:
            todo = explorations(plan, lab, ledger, observe)
            with _rivals(asked) as rivals:
                finals = [verify_choice(each, store, asked.best, rivals) for each in todo]
        else:
            outcomes = run_sweep(plan, lab, ledger, observe, started)
    if asked.verify_choice:
        held = [say_verified(console, final) for final in finals]
        return 0 if all(held) else 1
    say_outcomes(console, outcomes, ledger)
    if asked.write:
        finals = [outcome.final for outcome in outcomes if outcome.final is not None]
        write_choices(_folder(asked), asked.target, plan.target.name, asked.scene, finals)
        console.print(f"written: {_folder(asked)}", highlight=False, soft_wrap=True)
    console.print(f"store: {asked.place}", highlight=False, soft_wrap=True)
    return 1 if any(outcome.failed for outcome in outcomes) else 0


def say_too_short(plan: Plan, models: int = 1) -> None:
    """Before the work, where the minutes are fewer than the contests need."""
    contests = models * len(plan.contests)
    needed = USEFUL_MINUTES * contests
    if plan.minutes is not None and plan.minutes < needed:
        Console(stderr=True).print(
            f"carom: {plan.minutes:g} minutes are few: {contests} contests need about "
            f"{needed:g}; each gets its first candidates, and no more",
            highlight=False,
            soft_wrap=True,
        )


def _folder(asked: Asked) -> Path:
    return (asked.out or ROOT / "generated") / asked.target / asked.scene


def _require_places(asked: Asked) -> None:
    """What is wrong with a place shall be said before the work, not after."""
    if asked.verify_choice:
        with read_only(asked.place):
            pass
    if asked.rivals is not None and not asked.verify_choice:
        raise InputError(f"--rivals {asked.rivals}: is for --verify-choice, which was not given")
    with _rivals(asked):
        pass
    if asked.out is not None and not asked.write:
        raise InputError(f"--out {asked.out}: is for --write, which was not given")
    if asked.write:
        checked_selection(_folder(asked))
        require_writable(_folder(asked))


@contextmanager
def _rivals(asked: Asked) -> Iterator[ResultStore | None]:
    """The other store whose kernels a choice is timed against, if one was named."""
    if asked.rivals is None:
        yield None
        return
    with read_only(asked.rivals) as store:
        yield store


def _say_stopped(asked: Asked) -> None:
    Console(stderr=True).print(
        f"carom: stopped; all that was measured is kept in {asked.place}, and the same command "
        "goes on from there",
        highlight=False,
        soft_wrap=True,
    )


def _target(asked: Asked) -> Target:
    """The target; one that is not this host's CPU can be timed by a cluster alone."""
    target, host = resolve_target(asked.target)
    if not host.is_a(target) and asked.scheduler is None:
        raise InputError(
            f"--target {asked.target}: this host is {host.cpu} ({host.target.name}), and a time "
            "taken on another CPU is never the target's; use native, or --scheduler"
        )
    return target


def _contests(asked: Asked, target: Target, model: str, max_error: float) -> tuple[Contest, ...]:
    """Fixed steps and an error budget, scalar and batch calls, or what was asked for of these."""
    both = asked.steps is None and asked.max_error is None
    steps = asked.steps if asked.steps is not None else STEPS
    budget = asked.max_error if asked.max_error is not None else max_error
    plan_for(budget)
    goals: list[tuple[int | None, float | None]] = []
    if both or asked.max_error is not None:
        goals.append((None, budget))
    if both or asked.steps is not None:
        goals.append((steps, None))
    return tuple(
        Contest(target.name, asked.scene, model, *goal, call)
        for call in ("scalar", "batch")
        if asked.call in (None, call)
        for goal in goals
    )


@contextmanager
def _lab(asked: Asked, target: Target, model: str) -> Iterator[Lab]:
    with workbench(quiet=True) as bench:
        station = Station(bench, asked.scene, model)
        if asked.scheduler is None:
            yield LocalLab(station, target)
            return
        with connected(asked.scheduler) as client:
            from ..sweep.cluster import ClusterLab

            lab = ClusterLab(client, station, target, asked.wait)
            yield lab
            _say_refused(lab.refused.values())


def _say_refused(reasons: Iterable[str]) -> None:
    for why in reasons:
        Console(stderr=True).print(f"carom: not used: {why}", highlight=False, soft_wrap=True)
