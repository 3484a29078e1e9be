"""The main job's middle: candidates for a goal, verified, timed or modelled, and one chosen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from generator.choice.candidates import baseline, exact_candidates, fixed_step_candidates
from generator.choice.choose import Choice, choose_by_model, choose_by_time
from generator.choice.modelling import model_all
from generator.choice.workbench import (
    VERIFY_RANDOM,
    VERIFY_SEED,
    Candidate,
    Expected,
    Workbench,
)
from generator.targets.host import Host
from generator.targets.target import Target
from generator.variants.names import name_of

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
        candidates = bench.prepare(
            [first, *exact_candidates(target, scene, model, budget, codes)], target
        )
        bench.compile(candidates)
        expected = bench.expected(scene, model, STEPS, VERIFY_SEED, VERIFY_RANDOM)
        return _judged(bench, candidates, expected, target, host, scene, seconds)

    return job


def fixed_step_job(
    bench: Workbench, target: Target, host: Host, scene: str, model: str, seconds: float
) -> tuple[list[Candidate], Candidate, Choice]:
    """Candidates of the fixed-step scheme with their figures, the baseline, and the choice."""
    codes = list(bench.compilers)
    variants = fixed_step_candidates(target, scene, model, STEPS, codes)
    first = baseline(target, scene, model, STEPS, codes)
    variants = [first, *(v for v in variants if name_of(v) != name_of(first))]
    candidates = bench.prepare(variants, target)
    bench.compile(candidates)
    expected = bench.expected(scene, model, STEPS, VERIFY_SEED, VERIFY_RANDOM)
    return _judged(bench, candidates, expected, target, host, scene, seconds)


def verify(bench: Workbench, candidates: Sequence[Candidate], expected: Expected) -> None:
    """On all cases; under an emulator, which takes ms for each, on every fifth of them."""
    if bench.emulated is not None:
        expected = _thinned(expected)
    bench.verify(candidates, expected)
    bench.labels = expected.labels


def _thinned(expected: Expected) -> Expected:
    rows = slice(None, None, EMULATED)
    euler, pooltool = expected.euler, expected.pooltool
    return replace(
        expected,
        cases=expected.cases[rows],
        exact=expected.exact[rows],
        euler=None if euler is None else euler[rows],
        pooltool=None if pooltool is None else pooltool[rows],
        reference_rows=len(range(0, expected.reference_rows, EMULATED)),
        labels=expected.labels[rows],
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
    """Verified and timed where the target's code runs here; chosen by time on the target alone."""
    runs_here = host.runs(target)
    is_host = runs_here and host.target.name == target.name and host.exact
    if runs_here or bench.emulated is not None:
        verify(bench, candidates, expected)
    if runs_here:
        run = bench.time(candidates, candidates[0], scene, seconds)
    if is_host:
        return candidates, candidates[0], choose_by_time(candidates, run, host.target.name)
    cases = bench.timing_cases(scene, candidates[0].variant.model)
    model_all(bench, candidates, target, cases)
    return candidates, candidates[0], choose_by_model(candidates, target.row.mca_cpu)
