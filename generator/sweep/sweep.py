"""A whole sweep: contest after contest, each with its share of the budget, then its choice."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from random import Random

from ..choice.candidates import baseline, candidates_of, default_kernel
from ..choice.kernel import Rejected, Verified
from ..choice.seeds import recorded_of, seeds_of, steppers_of
from ..choice.trials import Final
from ..errors import InputError, KernelError
from ..evidence.records.evidence import Timings
from ..registry.lane_numbers import widths_for
from ..registry.question import Contest
from ..registry.variant import Variant
from ..targets.target import Target
from .explore import Budget, Exploration, Observer
from .finals import choose
from .lab import Lab
from .ledger import Ledger
from .search import Search
from .space import Space

USEFUL_MINUTES = 1.0  # that a contest needs at least: its first candidates and their final
FINAL_RESERVE = 60.0  # seconds of the budget kept for a contest's last wave and its final


@dataclass(frozen=True)
class Plan:
    """What a sweep is asked for."""

    target: Target
    contests: tuple[Contest, ...]
    only: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    compilers: tuple[str, ...] = ()
    seed: int = 1
    exhaustive: bool = False
    minutes: float | None = None
    trials: int | None = None
    timings: Timings = field(default_factory=Timings)  # whose fastest are tried first

    def space(self, contest: Contest) -> Space:
        """What may be tried in a contest."""
        there = widths_for(self.target, contest.known_scene, contest.goal.family)
        widths = tuple(width for width in there if (width > 1) == contest.batches)
        only = {**held_options(contest, self.target), **self.only}
        return Space(contest, self.target, self.compilers, widths, only)


def held_options(contest: Contest, target: Target) -> dict[str, tuple[str, ...]]:
    """What is not varied in a contest of batches: options of single collisions alone.

    They are those of the kernel that is used before anything was timed, so that a record of a batch
    does not depend on what was chosen for single calls.
    """
    if not contest.batches:
        return {}
    family = contest.goal.family
    first = default_kernel(contest)
    alone = [axis.key for axis in first.axes if axis.family == family and not axis.lanes]
    return {key: (first[key],) for key in alone}


@dataclass(frozen=True)
class Outcome:
    """What a contest ended with; `final` is None where nothing passed, or nothing was tried."""

    exploration: Exploration
    final: Final | None

    @property
    def failed(self) -> bool:
        return self.final is None and not self.exploration.untried


def require_spaces(plan: Plan) -> None:
    """Raise InputError where `only` leaves a contest without a legal variant."""
    for contest in plan.contests:
        if plan.space(contest).drawn(Random(plan.seed)) is None:
            family, call = contest.goal.family, contest.call
            raise InputError(
                f"--only: no legal variant of {family} kernels is left for {call} calls; "
                "allow more codes (see ./gen list variants)"
            )


def explorations(plan: Plan, lab: Lab, ledger: Ledger, observe: Observer) -> list[Exploration]:
    """One for each contest, not begun, its baseline built."""
    found = []
    for contest in plan.contests:
        space, random = plan.space(contest), Random(f"{plan.seed} {contest}")
        search = Search(space, _seeds(plan, contest), random, plan.exhaustive)
        first = _baseline(plan, contest, lab)
        found.append(Exploration(contest, search, first, lab, ledger, Budget(None, None), observe))
    return found


def _baseline(plan: Plan, contest: Contest, lab: Lab) -> Verified:
    variant = baseline(contest, plan.compilers)
    [(_, made)] = lab.build([lab.emit(variant)])
    if isinstance(made, Rejected):
        raise KernelError(
            f"{candidates_of(contest.row).baseline}, which all are timed against: {made.text}"
        )
    return made


def _seeds(plan: Plan, contest: Contest) -> list[Variant]:
    """What was fastest on the CPU before, then the main job's candidates, -Ofast last.

    In lanes: the kernels used before anything was timed, one of each stepper in turn.
    """
    first = default_kernel(contest)
    singles = [first.with_stepper(stepper) for stepper in steppers_of(contest)]
    known = seeds_of(contest, plan.compilers, singles)
    known.sort(key=lambda variant: variant["flags"] != "strict")
    return [*recorded_of(contest, plan.timings, [first]), *known]


def run_sweep(
    plan: Plan, lab: Lab, ledger: Ledger, observe: Observer, started: float
) -> list[Outcome]:
    """Explore and choose. `started`: when the budget's minutes began, on the monotonic clock.

    Every contest has its first wave before any has a second one, whatever the minutes.
    """
    require_spaces(plan)
    todo = explorations(plan, lab, ledger, observe)
    end = None if plan.minutes is None else started + 60 * plan.minutes
    trials, outcomes = plan.trials, []
    for number, exploration in enumerate(todo):
        exploration.budget = _share(None, trials, len(todo) - number, 0)
        if not exploration.budget.over(0):
            exploration.wave()
        trials = None if trials is None else trials - exploration.tried
    for number, exploration in enumerate(todo):
        before = exploration.tried
        exploration.budget = _share(end, trials, len(todo) - number, before)
        exploration.run()
        trials = None if trials is None else trials - exploration.tried + before
        final = choose(exploration)
        if final is not None:
            exploration.note_constraints(final.row(final.chosen).subject.variant())
        outcomes.append(Outcome(exploration, final))
    return outcomes


def _share(end: float | None, trials: int | None, left: int, tried: int) -> Budget:
    """An equal part of what is left; what a contest does not use goes to those after it."""
    deadline = None
    if end is not None:
        now = time.monotonic()
        deadline = now + (end - now) / left - FINAL_RESERVE
    return Budget(deadline, None if trials is None else tried - (-trials // left))
