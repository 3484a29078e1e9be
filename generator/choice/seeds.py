"""What a contest tries first: our short list, and what was fastest on its CPU before."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from ..evidence.records.evidence import Timings
from ..registry.axes import axis
from ..registry.question import Contest
from ..registry.recipe import FIXED
from ..registry.roots import is_reproducible
from ..registry.variant import Stepper, Variant
from ..targets.target import find_target
from .candidates import batch_candidates, candidates_of, singles_for

MORE = 6  # of the fastest recorded recipes that are candidates, too


def steppers_of(contest: Contest) -> tuple[Stepper, ...]:
    """Those that can reach a contest's goal."""
    goal = contest.goal
    known = candidates_of(contest.row).tableaus_for
    names = (FIXED,) if goal.budget is None else known(goal.budget)
    return tuple(Stepper(name, goal.steps, goal.budget) for name in names)


def seeds_of(
    contest: Contest,
    compilers: Sequence[str],
    singles: Sequence[Variant],
    reproducible: bool = False,
) -> list[Variant]:
    """What is tried first: for single calls our short list, else `singles` in lanes.

    One of each of `singles` in turn.
    """
    target = find_target(contest.target)
    if contest.batches:
        lanes = (batch_candidates(one, target, compilers, reproducible) for one in singles)
        return [v for some in itertools.zip_longest(*lanes) for v in some if v is not None]
    known = singles_for(contest, compilers, reproducible)
    return [v for v in known if is_reproducible(v)] if reproducible else known


def recorded_of(contest: Contest, timings: Timings, singles: Sequence[Variant]) -> list[Variant]:
    """What was fastest on the target's CPU before; lanes about the single calls of `singles`."""
    fastest = timings.fastest(contest, MORE)
    return [in_lanes_of(one, singles[0]) for one in fastest] if contest.batches else fastest


def in_lanes_of(fast: Variant, single: Variant) -> Variant:
    """The lanes of one kernel about the single calls of another."""
    lanes = {key: code for key, code in fast.options if axis(key).lanes}
    known = {"compiler": fast["compiler"], "fma": fast["fma"]}
    return single.with_stepper(fast.stepper).in_lanes(fast.width, **known, **lanes)
