"""How kernels of a ball and a cushion are judged: reference files, cases in scenes, fixed steps."""

from __future__ import annotations

import numpy as np
import pytest

from generator.evidence.timing.bench_tool import BenchTool
from generator.evidence.verification.errors import Array
from generator.evidence.verification.reference import load_reference
from generator.impacts.ball_cushion.columns import COLUMNS
from generator.impacts.ball_cushion.evidence import EVIDENCE
from generator.impacts.ball_cushion.parameters import NAMES
from generator.impacts.ball_cushion.scene import scenes
from tests.support.cushion import cushion_tool, load_outcomes

SEED, RANDOM = 5, 860


@pytest.fixture(scope="module")
def tool() -> BenchTool:
    return cushion_tool()


@pytest.fixture(scope="module")
def cases(tool: BenchTool) -> Array:
    return tool.make_cases(SEED, RANDOM, mixed=False).rows


def test_the_oracle_gives_the_reference(tool: BenchTool) -> None:
    reference = load_reference(EVIDENCE.reference)
    exact = tool.expect(reference.cases, "exact", "clamped")
    want = exact.copy()
    want[:, : COLUMNS.status] = load_outcomes("exact.csv", tuple(map(str, reference.ids)))
    errors = EVIDENCE.measure.errors_of(reference.cases, exact, want)
    print(f"{errors.relative.max():.2g} of |v|")
    assert errors.relative.max() <= 1e-12
    for (model, steps), published in reference.published.items():
        got = tool.expect(reference.cases, "euler", model, steps)
        assert EVIDENCE.measure.errors_of(reference.cases, got, published).relative.max() <= 1e-12


@pytest.mark.parametrize("name", sorted(scenes()))
def test_cases_lie_in_their_scene_and_are_impacts(tool: BenchTool, cases: Array, name: str) -> None:
    scene = scenes()[name]
    moved = EVIDENCE.cases_for_scene(scene, cases)
    for key, value in scene.fixed.items():
        assert (moved[:, NAMES.index(key)] == value).all()
    for key, (low, high) in scene.ranges.items():
        column = moved[:, NAMES.index(key)]
        assert ((column >= low) & (column <= high)).all()
    collide = tool.expect(moved, "screen", "clamped")[:, COLUMNS.status] == 0
    print(f"{name}: {collide.mean():.3f} of the cases collide")
    assert collide.mean() > 0.99
    if scene.unrestricted:
        assert (moved == cases).all()


def test_the_scheme_itself_passes_and_a_wrong_step_fails(tool: BenchTool, cases: Array) -> None:
    scheme = tool.expect(cases, "euler", "pooltool", 1000)
    exact = tool.expect(cases, "screen", "printed")
    width = COLUMNS.outcome_width
    same = EVIDENCE.fixed_verdict(cases, scheme[:, :width], scheme, exact, 1000)
    assert same.passed
    assert same.max_abs_error == 0
    wrong, lost = scheme[:, :width].copy(), scheme[:, :width].copy()
    wrong[:, 0] += 1e-2
    lost[3, COLUMNS.status] = 2
    for got in (wrong, lost, np.full_like(wrong, np.nan)):
        assert not EVIDENCE.fixed_verdict(cases, got, scheme, exact, 1000).passed
