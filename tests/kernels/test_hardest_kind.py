"""The hardest kind of collision takes at most ten times the evaluations of the mixed set's mean.

Evaluations of the rates are counted, not timed: they are the same on every machine, busy or not.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from generator.emission.kernel_source import emit
from generator.evidence.profiling.counting import count_operations
from generator.toolchain.flags import compile_flags
from tests.support.exact_kernels import MODELS, exact_variant, portable_target
from tests.support.kernels import bench_tool, compiler_of

SEED, EACH, MIXED = 33, 512, 4096
HARDEST = 10.0


def check(model: str, budget: float, cache: Path) -> None:
    tool, target = bench_tool(), portable_target()
    variant = exact_variant(model, budget, target=target)
    compiler = compiler_of(variant)
    kinds = len(set(tool.make_cases(SEED, 200, mixed=False).kinds))
    mixed, made = tool.make_cases(SEED, MIXED), tool.make_cases(SEED, kinds * EACH, mixed=False)
    cases = np.vstack([mixed.rows, made.rows])
    flags = compile_flags(variant, compiler, target)
    each = np.array(count_operations(emit(variant), compiler, flags, cases, cache).each)
    mean, names = each[:MIXED].mean(), np.array(made.kinds)
    taken = {str(kind): each[MIXED:][names == kind].mean() for kind in set(names)}
    ordered = sorted(taken, key=lambda kind: -taken[kind])
    text = ", ".join(f"{kind} {taken[kind] / mean:.2f}" for kind in ordered[:5])
    print(f"{model} {budget:g}: mixed set {mean:.1f} evaluations; of that mean: {text}")
    assert taken[ordered[0]] <= HARDEST * mean, ordered[0]


def test_hardest_kind(tmp_path: Path) -> None:
    check("mathavan2014", 1e-6, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("model", MODELS)
def test_hardest_kind_of_every_budget(model: str, tmp_path: Path) -> None:
    for budget in (1e-3, 1e-4, 1e-6, 1e-9, 1e-12):
        check(model, budget, tmp_path)
