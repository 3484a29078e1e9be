"""Does llvm-mca order kernels as the CPUs did that have records in `timings/`?

Of each contest a few kernels are modelled: the fastest recorded one, and for each option the
fastest that has it. All of them, and what the model's error is said to be:
`.venv/bin/python -m pytest -s -m long tests/choice/test_model_order.py`, which compiles 400 kernels
a CPU. Nothing is timed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from scipy.stats import kendalltau

from generator.choice.candidates import batch_candidates
from generator.choice.model_error import MODEL_ERROR, model_band
from generator.choice.modelling import model_all
from generator.choice.workbench import Workbench
from generator.evidence.records.evidence import Timings, key_of_kernel, read_timings
from generator.registry.question import Contest
from generator.registry.variant import Variant
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.compilers import find_compilers
from generator.toolchain.mca import find_mca
from generator.toolchain.replay import Modelled
from tests.support.contests import exact_candidates, fixed_step_candidates
from tests.support.kernels import CACHE, ROOT, bench_tool

WORST = 1.10  # of the fastest recorded may the kernel take that the model picks
NEAR = 1.25  # kernels that matter for a choice
GOALS = ("n1000", "e1m06")
# Each question once in `./check`, by the contact model in which more recipes are apart.
SOME = {
    "ball-ball/any/pooltool-n1000-scalar",
    "ball-ball/any/pooltool-n1000-batch",
    "ball-ball/any/mathavan2014-e1m06-scalar",
    "ball-ball/any/mathavan2014-e1m06-batch",
}


@dataclass(frozen=True)
class Recorded:
    variant: Variant
    ratio: float


@cache
def timings() -> Timings:
    return read_timings([ROOT])


@cache
def bench() -> Workbench:
    return Workbench(bench_tool(), CACHE.parent, {c.code: c for c in find_compilers()})


def contests(all_of_them: bool) -> list[tuple[str, Contest]]:
    return [
        (cpu, contest)
        for cpu in sorted(timings().by_cpu)
        for contest in timings().contests(cpu)
        if contest.scene == "any" and str(contest.goal) in GOALS
        if all_of_them or str(contest) in SOME
    ]


def recorded(cpu: str, contest: Contest) -> list[Recorded]:
    """The main job's candidates that the CPU has timed, the fastest first."""
    target, codes = find_target(cpu), list(bench().compilers)
    scene, model, goal = contest.scene, contest.model, contest.goal
    if contest.call == "batch":
        single = recorded(cpu, replace(contest, call="scalar"))[0].variant
        variants = batch_candidates(single, target, codes)
    elif goal.steps is not None:
        variants = fixed_step_candidates(target, scene, model, goal.steps, codes)
    else:
        variants = exact_candidates(target, scene, model, goal.budget, codes)
    there = timings().contest(cpu, contest)
    found = [
        Recorded(variant, there[kernel].ratio)
        for variant in variants
        for _, kernel in [key_of_kernel(variant)]
        if kernel in there
    ]
    return sorted(found, key=lambda each: each.ratio)


def representatives(kernels: Sequence[Recorded]) -> list[Recorded]:
    """The fastest of each option, the fastest of all first; of some that are the same, one."""
    first: dict[tuple[str, str], Recorded] = {}
    for each in kernels:
        options = {**dict(each.variant.options), "stepper": each.variant.stepper.name}
        for option in {**options, "width": str(each.variant.width)}.items():
            first.setdefault(option, each)
    return [each for each in kernels if any(each is one for one in first.values())]


def modelled(
    cpu: str, contest: Contest, kernels: Sequence[Recorded]
) -> list[tuple[float, Recorded]]:
    """Cycles of each kernel that llvm-mca can tell of, the fewest first."""
    target = find_target(cpu)
    emitted = bench().emit_all([each.variant for each in kernels], target)
    models = model_all(bench(), replace(contest, target=cpu), emitted)
    for name, model in models.items():
        assert isinstance(model, Modelled), f"{name}: {model}"
    pairs = zip((models[kernel.name].cycles for kernel in emitted), kernels, strict=True)
    return sorted(pairs, key=lambda pair: pair[0])


def pick(order: Sequence[tuple[float, Recorded]]) -> Recorded:
    """As choose_by_model: of what is told apart by nothing the recipe that has won most often."""
    least = order[0][0]
    near = [each for cycles, each in order if cycles <= least * (1 + model_band(each.variant))]
    return max(near, key=lambda each: timings().wins(each.variant))


def judged(cpu: str, contest: Contest, kernels: Sequence[Recorded]) -> list[tuple[float, Recorded]]:
    """Modelled, printed and held to what the model is for: the one it picks is fast."""
    if find_mca() is None:
        pytest.skip("no llvm-mca on this machine")
    if not read_host().runs(find_target(cpu)):
        pytest.skip(f"{cpu}'s code does not run on this machine, so nothing can be recorded")
    fastest = next(iter(timings().contest(cpu, contest).values())).ratio
    order = modelled(cpu, contest, kernels)
    for cycles, each in order:
        options = " ".join(code for _, code in each.variant.options)
        width = f"{each.variant.stepper.name} x{each.variant.width}"
        print(f"{cycles:9.0f} cycles, recorded {each.ratio:.4f}: {width} {options}")
    alone = order[0][1].ratio / fastest
    picked = pick(order).ratio / fastest
    rank = kendalltau([c for c, _ in order], [each.ratio for _, each in order]).statistic
    print(f"{cpu} {contest}: {len(order)} kernels, Kendall's tau {rank:.2f}; the model's pick")
    print(f"takes {alone:.3f} of the fastest recorded, the choice {picked:.3f}")
    assert picked <= WORST
    return order


@pytest.mark.parametrize(("cpu", "contest"), contests(all_of_them=False), ids=str)
def test_the_models_pick_was_among_the_fastest(cpu: str, contest: Contest) -> None:
    judged(cpu, contest, representatives(recorded(cpu, contest)))


def test_a_cpu_has_records_to_hold_the_model_to() -> None:
    found = contests(all_of_them=False)
    print(f"{len(found)} contests of {len(timings().by_cpu)} CPUs")
    assert {cpu for cpu, _ in found} >= {"zen3"}
    assert len(found) >= len(SOME)


@pytest.mark.long
@pytest.mark.parametrize(("cpu", "contest"), contests(all_of_them=True), ids=str)
def test_the_model_errs_by_no_more_than_is_said(cpu: str, contest: Contest) -> None:
    order = judged(cpu, contest, recorded(cpu, contest))
    fastest = min(each.ratio for _, each in order)
    off = np.log([cycles / each.ratio for cycles, each in order])
    near = np.array([each.ratio <= NEAR * fastest for _, each in order])
    spread, most = float(np.std(off[near])), float(np.exp(np.ptp(off)))
    band = model_band(order[0][1].variant)
    print(f"off by {spread:.3f} near the fastest, said {band}; by {most:.2f} at most")
    assert spread <= band
    assert most <= MODEL_ERROR
