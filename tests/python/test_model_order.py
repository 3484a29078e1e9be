"""Does llvm-mca's replay order kernels as this machine's clock does? Long: it times what it models.

`.venv/bin/python -m pytest -s -m long tests/python/test_model_order.py`
"""

from __future__ import annotations

import numpy as np
import pytest
from kernels import CACHE, bench_tool
from scipy.stats import kendalltau

from generator.choice.candidates import exact_candidates, fixed_step_candidates
from generator.choice.modelling import model_all
from generator.choice.workbench import TIMING_CASES, TIMING_SEED, Candidate, Workbench
from generator.targets.host import read_host
from generator.timing.plan import PlannedKernel, TimingPlan
from generator.timing.ratios import timing_results
from generator.toolchain.compilers import find_compilers
from generator.toolchain.mca import find_mca
from generator.variants.variant import Variant

ROOTS = ("inv", "est1", "cubic")  # exact enough for 1e-6
FAMILIES = ("fixed", "exact")
SECONDS = 30.0


def variants(family: str) -> list[Variant]:
    target, codes = read_host().target, ("gcc", "clang")
    if family == "exact":
        found = exact_candidates(target, "any", "mathavan2014", 1e-6, codes)
        return [v for v in found if v["root"] in ROOTS]
    return fixed_step_candidates(target, "any", "mathavan2014", 1000, codes)[::3]


@pytest.mark.long
@pytest.mark.parametrize("family", FAMILIES)
def test_the_fastest_by_the_model_is_among_the_fastest_by_time(family: str) -> None:
    if find_mca() is None:
        pytest.skip("no llvm-mca on this machine")
    tool, target = bench_tool(), read_host().target
    bench = Workbench(tool, CACHE.parent, {c.code: c for c in find_compilers()})
    candidates = bench.prepare(variants(family), target)
    bench.compile(candidates)
    cases = tool.make_cases(TIMING_SEED, TIMING_CASES).rows
    kernels = tuple(PlannedKernel(c.name, c.library.path) for c in candidates if c.library)
    plan = TimingPlan(cases, kernels, kernels[0].name, rounds=1000, seconds=SECONDS)
    ticks = {result.name: result.cycles for result in timing_results(tool.time(plan))}
    model_all(bench, candidates, target, cases)
    order = _printed(family, candidates, ticks)
    chosen = min(order, key=lambda pair: pair[0])[1] / min(time for _, time in order)
    rank = kendalltau(*np.array(order).T).statistic
    print(f"{family}: {len(order)} kernels, Kendall's tau {rank:.2f}; the fastest by the model")
    print(f"takes {chosen:.3f} times as long as the fastest by the clock")
    assert rank >= 0.5
    assert chosen <= 1.1


def _printed(
    family: str, candidates: list[Candidate], ticks: dict[str, float]
) -> list[tuple[float, float]]:
    """Modelled cycles and measured ticks of each kernel, printed beside each other."""
    order = []
    for candidate in candidates:
        assert candidate.modelled is not None, candidate.rejected
        modelled, measured = candidate.modelled.cycles, ticks[candidate.name]
        order.append((modelled, measured))
        print(f"{modelled:9.0f} cycles, {measured:9.0f} ticks, {candidate.name}")
    return order
