"""The main job's middle: candidates for a goal, verified, timed or modelled, and one chosen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from ..registry.roots import is_reproducible
from ..registry.variant import Variant
from ..targets.host import Host
from ..targets.target import Target
from .candidates import baseline, exact_candidates, fixed_step_candidates
from .choose import Choice, choose_by_time
from .modelling import model_all
from .recorded import choose_elsewhere, with_recorded
from .sought import choose_sought
from .verifying import Expected, HardCases
from .workbench import (
    VERIFY_RANDOM,
    VERIFY_SEED,
    Candidate,
    Workbench,
)

STEPS = 1000
EMULATED = 5  # of the cases one in so many runs under an emulator

Job = Callable[
    [Workbench, Target, Host, str, str, float], tuple[list[Candidate], Candidate, Choice]
]


def exact_job(budget: float) -> Job:
    """The job for an error budget: candidates, the baseline first, and the choice."""

    def job(
        bench: Workbench, target: Target, host: Host, scene: str, model: str, seconds: float
    ) -> tuple[list[Candidate], Candidate, Choice]:
        codes = list(bench.compilers)
        first = baseline(target, scene, model, STEPS, codes)
        variants = exact_candidates(target, scene, model, budget, codes, bench.reproducible)
        candidates = _prepared(bench, first, variants, target)
        expected = bench.expected(scene, model, STEPS, VERIFY_SEED, VERIFY_RANDOM)
        return _judged(bench, candidates, expected, target, host, scene, seconds)

    return job


def fixed_step_job(
    bench: Workbench, target: Target, host: Host, scene: str, model: str, seconds: float
) -> tuple[list[Candidate], Candidate, Choice]:
    """Candidates of the fixed-step scheme with their figures, the baseline, and the choice."""
    codes = list(bench.compilers)
    variants = fixed_step_candidates(target, scene, model, STEPS, codes)
    if bench.reproducible:
        variants = [v for v in variants if is_reproducible(v)]
    first = baseline(target, scene, model, STEPS, codes)
    candidates = _prepared(bench, first, variants, target)
    expected = bench.expected(scene, model, STEPS, VERIFY_SEED, VERIFY_RANDOM)
    return _judged(bench, candidates, expected, target, host, scene, seconds)


def _prepared(
    bench: Workbench, first: Variant, variants: Sequence[Variant], target: Target
) -> list[Candidate]:
    """The baseline, the variants and what was fastest on the target's CPU, compiled."""
    known = with_recorded(bench, [first, *variants], target, variants[-1].question.contest)
    candidates = bench.prepare(known, target)
    bench.compile(candidates)
    return candidates


def verify(bench: Workbench, candidates: Sequence[Candidate], expected: Expected) -> Expected:
    """On all cases; under an emulator, which takes ms for each, on every fifth. Returns these."""
    if bench.emulated is not None:
        expected = _thinned(expected)
    bench.verify(candidates, expected)
    bench.labels = expected.labels
    return expected


def _thinned(expected: Expected) -> Expected:
    rows = slice(None, None, EMULATED)
    labels, usual = expected.labels, len(expected.cases)
    euler, pooltool, hard = expected.euler, expected.pooltool, expected.hard
    return replace(
        expected,
        cases=expected.cases[rows],
        exact=expected.exact[rows],
        euler=None if euler is None else euler[rows],
        pooltool=None if pooltool is None else pooltool[rows],
        reference_rows=len(range(0, expected.reference_rows, EMULATED)),
        hard=HardCases(hard.cases[rows], hard.exact[rows], hard.steep[rows]),
        labels=(*labels[:usual][rows], *labels[usual:][rows]),
        key=f"{expected.key}, every {EMULATED}th",
    )


def _judged(
    bench: Workbench,
    candidates: list[Candidate],
    expected: Expected,
    target: Target,
    host: Host,
    scene: str,
    seconds: float,
) -> tuple[list[Candidate], Candidate, Choice]:
    """Verified where the target's code runs; timed where this is the target's CPU alone.

    Else chosen by what was timed on such a CPU, and by llvm-mca.
    """
    first, own = candidates[0], None
    if host.runs(target) or bench.emulated is not None:
        own = verify(bench, candidates, expected)
    if host.is_a(target):
        run = bench.time(candidates, first, scene, seconds)
        choice = choose_sought(bench, own, lambda: choose_by_time(candidates, run, host))
        return candidates, first, choice

    def model(some: Sequence[Candidate]) -> None:
        model_all(bench, some, target, bench.timing_cases(scene, first.variant.model))

    choice = choose_sought(
        bench, own, lambda: choose_elsewhere(bench, candidates, first, target, model)
    )
    return candidates, first, choice
