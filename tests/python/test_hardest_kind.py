"""The hardest kind of collision takes at most ten times the mean of the mixed set."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from exact_kernels import MODELS, built, exact_variant, host_target
from kernels import bench_tool

from generator.timing.bench_tool import BenchTool
from generator.timing.plan import PlannedKernel, TimingPlan
from generator.verification.errors import Array

SEED, EACH, MIXED = 33, 512, 4096
HARDEST = 10.0


def nanoseconds(tool: BenchTool, library: Path, cases: Array, rounds: int) -> float:
    """The median over rounds, for one collision of independent ones."""
    kernel = PlannedKernel("kernel", library)
    plan = TimingPlan(cases, (kernel,), "kernel", rounds=rounds, seconds=2.0, block_ms=0.5)
    return float(np.median(tool.time(plan).throughput.ns["kernel"]))


def check(tool: BenchTool, model: str, budget: float, rounds: int) -> None:
    library = built([exact_variant(model, budget, target=host_target())])[0]
    mean = nanoseconds(tool, library, tool.make_cases(SEED, MIXED).rows, 4 * rounds)
    kinds = len(set(tool.make_cases(SEED, 200, mixed=False).kinds))
    made = tool.make_cases(SEED, kinds * EACH, mixed=False)
    names = np.array(made.kinds)
    times = {
        kind: nanoseconds(tool, library, made.rows[names == kind], rounds) for kind in set(names)
    }
    ordered = sorted(times, key=lambda kind: -times[kind])
    text = ", ".join(f"{kind} {times[kind] / mean:.2f}" for kind in ordered[:5])
    print(f"{model} {budget:g}: mixed set {mean:.0f} ns; of that mean: {text}")
    assert times[ordered[0]] <= HARDEST * mean, ordered[0]


def test_hardest_kind() -> None:
    check(bench_tool(), "mathavan2014", 1e-6, 8)


@pytest.mark.long
@pytest.mark.parametrize("model", MODELS)
def test_hardest_kind_of_every_budget(model: str) -> None:
    for budget in (1e-3, 1e-4, 1e-6, 1e-9, 1e-12):
        check(bench_tool(), model, budget, 30)
