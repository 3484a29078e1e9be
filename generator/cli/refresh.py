"""What gen results refresh does: a sweep of each contact model, then the records as text."""

from __future__ import annotations

import shlex
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console

from ..choice.job import STEPS
from ..errors import InputError
from ..evidence.records.evidence import read_timings
from ..evidence.records.files import timings_path
from ..files import require_place
from ..impacts.ball_ball.models import MODELS, find_model
from ..places import cache_folder
from ..registry.lane_numbers import widths_for
from ..steppers.exact.budgets import plan_for
from ..sweep.lab import Lab, LocalLab
from ..sweep.ledger import new_run
from ..sweep.record import Run
from ..sweep.refresh import contests_of, refresh
from ..sweep.station import Station
from ..sweep.store import opened
from ..sweep.sweep import Plan
from ..targets.host import Host
from ..targets.target import Target
from .interrupts import kept
from .session import RECORDED, ROOT, resolve_target, workbench
from .sweep_display import SweepDisplay, displayed
from .sweep_run import say_too_short

SCENE, SEED, FILE = "any", 1, "refresh.sqlite"


def run(
    cpu: str,
    minutes: float,
    budgets: tuple[float, ...],
    models: tuple[str, ...],
    store: Path | None,
    out: Path | None,
) -> int:
    """The command's exit status: 1 where nothing passed in a contest."""
    target, host = resolve_target(cpu)
    if not host.is_a(target):
        raise InputError(
            f"--cpu {cpu}: this machine is {host.cpu} ({_near(host)}), and a time taken on another "
            "CPU is never the target's; run it on such a machine"
        )
    names = [find_model(name).name for name in models] or [model.name for model in MODELS]
    for budget in budgets:
        plan_for(budget)
    place = out or timings_path(ROOT, target.name)
    if out is not None:
        require_place(out)
    plan = _plan(target, budgets, minutes)
    say_too_short(plan, len(names))
    started, errors = time.monotonic(), Console(stderr=True)
    command = " ".join(["./gen", *map(shlex.quote, sys.argv[1:])])

    @contextmanager
    def lab_of(model: str) -> Iterator[Lab]:
        with workbench(quiet=True) as bench:
            yield LocalLab(Station(bench, SCENE, model), target)

    def run_of(lab: Lab) -> Run:
        return new_run(command, SEED, lab.cpu, target.name, lab.compilers, host.cpuid)

    def say(line: str) -> None:
        Console().print(line, highlight=False, markup=False, soft_wrap=True)

    display = SweepDisplay(started, started + 60 * minutes, None)
    with (
        opened(store or cache_folder() / FILE) as kept_in,
        displayed(display, errors) as show,
        kept(show) as observe,
    ):
        outcomes = refresh(plan, names, lab_of, kept_in, run_of, place, observe, say)
    for outcome in outcomes:
        final = outcome.final
        best = f"{final.fastest} is the fastest" if final else "no kernel was timed to the end"
        say(f"{outcome.exploration.contest.name}: {best}")
    say(f"{(time.monotonic() - started) / 60:.1f} minutes on {host.cpu} ({target.name})")
    return 1 if any(outcome.failed for outcome in outcomes) else 0


def _near(host: Host) -> str:
    return host.target.name if host.exact else f"no named CPU; it runs {host.target.name}"


def _plan(target: Target, budgets: tuple[float, ...], minutes: float) -> Plan:
    wide = tuple(w for w in widths_for(target, SCENE, "exact") if w > 1)
    return Plan(
        target=target,
        contests=contests_of(target.name, SCENE, STEPS, budgets),
        widths={"scalar": (1,), "batch": wide},
        only={},
        compilers=(),
        seed=SEED,
        exhaustive=False,
        minutes=minutes,
        trials=None,
        timings=read_timings(RECORDED, lambda line: Console(stderr=True).print(f"carom: {line}")),
    )
