"""Kernels that are known to be over: a short search finds what is wrong with each.

The screening oracle, which answers every candidate, must not hide it: it is held against the oracle
in long double where inputs are hardest.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from generator.emission.kernel_source import emit
from generator.evidence.challenge.search import Limits, Subject, search
from generator.impacts.ball_ball.evidence import MODELS
from generator.impacts.ball_ball.scene import find_scene
from generator.impacts.ball_ball.search.envelope import envelope
from generator.registry.variant import Stepper, make_variant
from generator.toolchain.build import build_library
from generator.toolchain.compilers import find_compilers
from tests.support.kernels import bench_tool
from tests.support.reference import load_hard, load_reference

BUDGET, MODEL = 1e-6, "bottom_slip"
# How far the oracles may be apart, over the fastest speed: what a table drives on is steep.
APART = {"mathavan2014": 1e-14, "bottom_slip": 1e-14, "pooltool": 1e-10}
# What a constant of the step control held, and what becomes of it without: (name, value).
BROKEN = (
    ("kTail", 0.0),  # errors of the step into sticking
    ("kRest", 2.0),  # table slip that counts as none
    ("kPassage", 1e4),  # passages of the table slip by zero
    ("kCounts", 1e5),  # friction on the table that is of account
)


@pytest.mark.parametrize(("constant", "value"), BROKEN)
def test_search_finds_what_a_constant_of_the_step_control_held(
    constant: str, value: float, tmp_path: Path
) -> None:
    source = emit(make_variant("x86-64-v2", "any", MODEL, Stepper("dp54", budget=BUDGET)))
    text, count = re.subn(
        rf"(constexpr double {constant} =\s*)[^;]+;", rf"\g<1>{value};", source.source
    )
    assert count == 1
    files = {**source.files, "kernel.cpp": text}
    words = ("-std=c++17", "-O1", "-w", "-march=nehalem")
    library = build_library(files, (), find_compilers()[0], words, tmp_path, "broken").path
    within = envelope(find_scene("any"), MODEL, "scene")
    found = search(Subject(bench_tool(), library, within, BUDGET, batch=False), Limits(10_000), 1)
    print(f"{constant} = {value}: {found.worst.over:.3g} of the budget")
    assert found.worst.over > 1
    assert not found.held


@pytest.mark.parametrize("model", MODELS)
def test_the_screening_oracle_agrees_with_the_exact_one(model: str) -> None:
    """In lanes of doubles, each with another number of steps; masses differ in the second half."""
    tool = bench_tool()
    random = tool.make_cases(3, 3000, mixed=False).rows
    cases = np.concatenate([load_hard()[1], load_reference().cases, random])
    for more in ((), ("mass_ratio=0.7",)):
        exact = tool.expect(cases, "exact", model, more=more)
        screen = tool.expect(cases, "screen", model, more=more)
        radius = cases[:, :1]
        sizes = np.tile(np.repeat([1.0, 0.0, 1.0, 0.0], 3), (len(cases), 1))
        sizes = np.where(sizes > 0, 1.0, radius)
        fastest = (np.abs(exact[:, :12]) * sizes).max(axis=1) + 1e-300
        off = (np.abs(screen - exact)[:, :12] * sizes).max(axis=1) / fastest
        print(f"{model} {more}: off by {np.sort(off)[-3:]} of the fastest speed")
        assert (screen[:, 12] == exact[:, 12]).all()
        assert off.max() < APART[model]
