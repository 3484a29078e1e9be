"""The whole registry explored for one CPU, every trial kept."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path

from ..choice.candidates import candidates_of
from ..choice.entries import selected_by_sweep, write_selected
from ..choice.folder import checked_selection, require_writable
from ..choice.job import STEPS
from ..choice.selection import place_of
from ..choice.trials import Final, Run
from ..errors import InputError
from ..evidence.verification.evidence import evidence_of
from ..registry.lane_numbers import widths_for
from ..registry.question import CALLS, DEFAULT_IMPACT, Call, Contest, Goal, find_impact
from ..steppers.budgets import plan_for
from ..sweep.explore import Observer
from ..sweep.lab import Lab
from ..sweep.ledger import Ledger, new_run
from ..sweep.recheck import verify_choice
from ..sweep.space import parse_only
from ..sweep.store import ResultStore, default_store, opened, read_only
from ..sweep.sweep import USEFUL_MINUTES, Outcome, Plan, explorations, require_spaces, run_sweep
from ..targets.host import read_host
from ..targets.target import Target
from .cluster import connected
from .session import Session, resolve_target

DEFAULT_MINUTES = 19.0


@dataclass(frozen=True)
class SweepRequest:
    """What a sweep explores, for how long, and what it does with the choice.

    `steps` or `max_error`, `call`: contests of these alone. `only`: texts AXIS=CODE,... of the
    codes that an option may have. `minutes`, `trials`: where it ends (None with neither nor
    `exhaustive`: `DEFAULT_MINUTES`). `seed`: of what is drawn at random. `store`: the file that
    keeps the records; None: that in the cache. `fresh`: trials are made anew. `write`: write the
    choices to `generated/`, or to `out`. `scheduler`: address of a Dask cluster, whose workers
    are waited for for `wait` seconds. `command`: what the records name as having made them.
    """

    target: str = "native"
    scene: str = "any"
    model: str | None = None
    steps: int | None = None
    max_error: float | None = None
    call: Call | None = None
    only: tuple[str, ...] = ()
    minutes: float | None = None
    trials: int | None = None
    exhaustive: bool = False
    seed: int = 1
    store: Path | None = None
    fresh: bool = False
    write: bool = False
    out: Path | None = None
    scheduler: str | None = None
    wait: float = 60.0
    command: str = "generator.api.sweep"
    impact: str = DEFAULT_IMPACT

    @property
    def limit(self) -> float | None:
        """Minutes; None: no limit."""
        endless = self.trials is not None or self.exhaustive
        return DEFAULT_MINUTES if self.minutes is None and not endless else self.minutes

    def place(self, session: Session) -> Path:
        """The store that is used."""
        return self.store or default_store(session.cache)

    def folder(self, session: Session) -> Path:
        """Where choices are written."""
        return place_of(self.out or session.generated, self.target, self.scene, self.impact)


@dataclass(frozen=True)
class Swept:
    """What each contest ended with.

    `store`: where the records are. `written`: the folder that the choices went to. `made`,
    `reused`: trials. `unused`: why stored trials were not used, and how many.
    """

    outcomes: tuple[Outcome, ...]
    store: Path
    written: Path | None
    made: int
    reused: int
    unused: dict[str, int]

    @property
    def failed(self) -> bool:
        """Did nothing pass in a contest?"""
        return any(outcome.failed for outcome in self.outcomes)


def sweep(
    asked: SweepRequest, observe: Observer = lambda progress: None, session: Session | None = None
) -> Swept:
    """Explore the registry for a CPU, keep every trial, choose the fastest kernels.

    `observe` is told of each trial. Raises InputError where the request cannot be.
    """
    session, started = session or Session(), time.monotonic()
    if asked.out is not None and not asked.write:
        raise InputError(f"--out {asked.out}: is for --write, which was not given")
    if asked.write:
        checked_selection(asked.folder(session))
        require_writable(asked.folder(session))
    with _begun(asked, session) as (plan, lab, _, ledger):
        outcomes = run_sweep(plan, lab, ledger, observe, started)
    entries = [selected_by_sweep(each.final) for each in outcomes if each.final is not None]
    folder = asked.folder(session) if asked.write and entries else None
    if folder is not None:
        write_selected(folder, asked.target, entries)
    place, unused = asked.place(session), dict(sorted(ledger.unused.items()))
    return Swept(tuple(outcomes), place, folder, ledger.made, ledger.reused, unused)


def verify_choices(
    asked: SweepRequest,
    best: int = 5,
    rivals: Path | None = None,
    observe: Observer = lambda progress: None,
    session: Session | None = None,
) -> tuple[Final, ...]:
    """Time the stored choice of each contest against the next `best` ones again.

    `rivals`: another store, whose kernels it is timed against, too. Raises InputError where a store
    is not there.
    """
    session = session or Session()
    with (
        read_only(asked.place(session)),
        nullcontext() if rivals is None else read_only(rivals) as others,
        _begun(asked, session) as (plan, lab, store, ledger),
    ):
        todo = explorations(plan, lab, ledger, observe)
        return tuple(verify_choice(each, store, best, others) for each in todo)


@contextmanager
def _begun(
    asked: SweepRequest, session: Session
) -> Iterator[tuple[Plan, Lab, ResultStore, Ledger]]:
    """The plan, the machines that do the work, the opened store, and its trials."""
    impact = find_impact(asked.impact)
    if asked.scheduler is not None and asked.impact != DEFAULT_IMPACT:
        raise InputError(
            f"--scheduler with --impact {asked.impact}: workers of a cluster know "
            f"{DEFAULT_IMPACT} alone; sweep on this machine"
        )
    target = _target(asked)
    scene = impact.find_scene(asked.scene)
    model = impact.find_model(asked.model or scene.model).name
    contests = _contests(asked, target, model, scene.max_error)
    only = parse_only(asked.only)
    contests = tuple(c for c in contests if not c.batches or _has_lanes(c, target))
    if not contests:
        why = scene.without_exact_lanes or f"nothing that is asked for has lanes on {target.name}"
        raise InputError(f"--call {asked.call}: {why}; expected scalar")
    with _lab(asked, target, session) as lab:
        plan = Plan(
            target=target,
            contests=contests,
            only=only,
            compilers=tuple(lab.compilers),
            seed=asked.seed,
            exhaustive=asked.exhaustive,
            minutes=asked.limit,
            trials=asked.trials,
            timings=session.timings(),
        )
        require_spaces(plan)
        with opened(asked.place(session)) as store:
            note_too_short(plan, session)
            yield plan, lab, store, Ledger(store, _run(asked, plan, lab), asked.fresh)


def baseline_of(contest: object) -> str:
    """What all of a contest are timed against; `contest`: it, or as it is written."""
    return candidates_of(find_impact(str(contest).split("/")[0])).baseline


def _has_lanes(contest: Contest, target: Target) -> bool:
    """Has the contest's stepper kernels of lanes on the target?"""
    family, scene = contest.goal.family, contest.known_scene
    if contest.goal.budget is None:
        there = bool(candidates_of(contest.row).fixed_lanes)
    else:
        there = not scene.without_exact_lanes
    return there and any(width > 1 for width in widths_for(target, scene, family))


def _run(asked: SweepRequest, plan: Plan, lab: Lab) -> Run:
    cpuid = read_host().cpuid if asked.scheduler is None else None
    return new_run(asked.command, plan.seed, lab.cpu, plan.target.name, lab.compilers, cpuid)


def note_too_short(plan: Plan, session: Session, models: int = 1) -> None:
    """Before the work, where the minutes are fewer than the contests need."""
    contests = models * len(plan.contests)
    needed = USEFUL_MINUTES * contests
    if plan.minutes is not None and plan.minutes < needed:
        session.listener.note(
            f"{plan.minutes:g} minutes are few: {contests} contests need about {needed:g}; each "
            "gets its first candidates, and no more"
        )


def _target(asked: SweepRequest) -> Target:
    """The target; one that is not this host's CPU can be timed by a cluster alone."""
    target, host = resolve_target(asked.target)
    if not host.is_a(target) and asked.scheduler is None:
        raise InputError(
            f"--target {asked.target}: this host is {host.cpu} ({host.target.name}), and a time "
            "taken on another CPU is never the target's; use native, or --scheduler"
        )
    return target


def _contests(
    asked: SweepRequest, target: Target, model: str, max_error: float
) -> tuple[Contest, ...]:
    """Fixed steps and an error budget, scalar and batch calls, or what was asked for of these."""
    both = asked.steps is None and asked.max_error is None
    budget = asked.max_error if asked.max_error is not None else max_error
    plan_for(budget)
    steps_alone = model in evidence_of(find_impact(asked.impact)).exact_models
    if steps_alone and asked.max_error is not None:
        raise InputError(f"--max-error: model {model} has fixed steps alone; leave it out")
    goals = []
    if (both and not steps_alone) or asked.max_error is not None:
        goals.append(Goal(budget=budget))
    if both or asked.steps is not None:
        goals.append(Goal(steps=asked.steps if asked.steps is not None else STEPS))
    return tuple(
        Contest(asked.impact, target.name, asked.scene, model, goal, call)
        for call in CALLS
        if asked.call in (None, call)
        for goal in goals
    )


@contextmanager
def _lab(asked: SweepRequest, target: Target, session: Session) -> Iterator[Lab]:
    with session.without_steps().workbench(impact=find_impact(asked.impact)) as bench:
        if asked.scheduler is None:
            yield Lab(bench, target)
            return
        with connected(asked.scheduler) as client:
            from ..sweep.cluster import ClusterLab

            lab = ClusterLab(client, bench, target, asked.wait)
            yield lab
            for why in lab.refused.values():
                session.listener.note(f"not used: {why}")
