"""Batches: for a chosen kernel, which lanes its batch function should have."""

from __future__ import annotations

from collections.abc import Sequence

from ..registry.axes import axis
from ..registry.variant import Variant
from ..targets.host import Host
from ..targets.target import Target
from .candidates import batch_candidates
from .choose import Choice, choose_by_time
from .job import STEPS, verify
from .modelling import model_all
from .recorded import MORE, choose_elsewhere, legal_here
from .sought import choose_sought
from .workbench import VERIFY_RANDOM, VERIFY_SEED, Candidate, Workbench


def batch_job(
    bench: Workbench,
    target: Target,
    host: Host,
    scene: str,
    first: Candidate,
    single: Candidate,
    seconds: float,
) -> tuple[list[Candidate], Candidate, Choice] | None:
    """Candidates (the baseline `first`, the chosen `single`, then lanes), baseline and choice.

    None where the target or the stepper has no lanes, or where none of them verified.
    """
    codes = list(bench.compilers)
    variants = batch_candidates(single.variant, target, codes, bench.reproducible)
    if not variants:
        return None
    variants = _with_recorded_lanes(bench, variants, single.variant, target)
    candidates = bench.prepare([first.variant, single.variant, *variants], target)
    bench.compile(candidates)
    wide, own = candidates[2:], None
    if host.runs(target) or bench.emulated is not None:
        expected = bench.expected(scene, single.variant.model, STEPS, VERIFY_SEED, VERIFY_RANDOM)
        own = verify(bench, candidates, expected)
        if all(c.rejected for c in wide):
            return None
    if host.is_a(target):
        run = bench.time(candidates, candidates[0], scene, seconds, batches=True)
        choice = choose_sought(bench, own, lambda: choose_by_time(wide, run, host))
        return candidates, candidates[0], choice

    def model(some: Sequence[Candidate]) -> None:
        model_all(bench, some, target, bench.batch_cases(scene, single.variant.model))

    choice = choose_sought(
        bench, own, lambda: choose_elsewhere(bench, wide, candidates[0], target, model)
    )
    return candidates, candidates[0], choice


def _with_recorded_lanes(
    bench: Workbench, variants: list[Variant], single: Variant, target: Target
) -> list[Variant]:
    """And the lanes that were fastest on the target's CPU, with single calls as chosen."""
    found = [*variants]
    for fast in bench.timings.fastest(variants[0].question.contest, target.name, MORE):
        found.append(in_lanes_of(fast, single))
    return legal_here(bench, found, target)


def in_lanes_of(fast: Variant, single: Variant) -> Variant:
    """The lanes of one kernel about the single calls of another."""
    lanes = {key: code for key, code in fast.options if axis(key).lanes}
    known = {"compiler": fast["compiler"], "fma": fast["fma"]}
    return single.with_stepper(fast.stepper).in_lanes(fast.width, **known, **lanes)
