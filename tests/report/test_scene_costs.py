"""gen list scenes --cost: what a scene rules out is gone, in operations and in time."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from generator.choice.workbench import Workbench
from generator.cli.main import gen
from generator.report.figures.scene_costs import SceneCost, scene_costs
from generator.toolchain.compilers import find_compilers
from tests.support.exact_kernels import portable_target
from tests.support.kernels import CACHE, bench_tool

# Largest shares of the operations and of the time of `any` (a noisy machine's, so with room).
MOST = {"stun": (0.6, 0.85), "free": (0.5, 0.9), "break": (0.995, 1.1), "pool": (0.9995, 1.1)}


@pytest.fixture(scope="module")
def costs() -> dict[str, SceneCost]:
    compilers = {c.code: c for c in find_compilers()}
    bench = Workbench(bench_tool(), CACHE.parent / "test-figures", compilers)
    return {c.scene: c for c in scene_costs(bench, portable_target(), tuple(MOST), 1.0)}


@pytest.mark.parametrize("scene", MOST)
def test_a_scene_takes_fewer_operations_and_no_more_time(
    scene: str, costs: dict[str, SceneCost]
) -> None:
    cost, (operations, time) = costs[scene], MOST[scene]
    print(
        f"{scene}: {cost.collision.flops_per_collision:.0f} flops a collision where any takes "
        f"{cost.collision_any.flops_per_collision:.0f}, {cost.speed.ns:.0f} ns for "
        f"{cost.ns_any:.0f}: "
        f"{cost.flops_ratio:.3f} of the operations, {cost.speed.ratio:.3f} of the time"
    )
    assert cost.flops_ratio <= operations
    assert cost.speed.ratio_ci[0] <= time  # the interval is wide on a busy machine


def test_only_scenes_have_costs() -> None:
    result = CliRunner().invoke(gen, ["list", "models", "--cost"])
    assert result.exit_code == 2
    assert "expected list scenes --cost" in result.output
