"""Where an exact kernel changes its method, results of both sides agree to a hundredth of E.

Pairs of states, just below and just above a threshold: how much more do the kernel's results differ
than the exact ones? Calls compute in doubles; what floats round in lanes is larger than E/100.

Two kinds of threshold do not hold that. Where table slip begins to count, other steps follow,
whose errors differ: docs/step-control.md, "Jumps". And without friction, or with no ball pressed,
a closed form is exact, where steps with roots by estimates are off by up to 0.035 E at 1e-6.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from generator.emission.kernel_source import emit
from generator.evidence.verification.errors import Array
from generator.impacts.ball_ball.evidence import MODELS
from generator.impacts.ball_ball.scene import find_scene
from generator.impacts.ball_ball.search.balls import cases_of
from generator.impacts.ball_ball.search.charts import Layout, States
from generator.impacts.ball_ball.search.envelope import envelope
from tests.support.exact_kernels import built, exact_variant
from tests.support.kernels import bench_tool

PAIRS = 400
BESIDE = 2e-3  # relative, of the threshold of a slip: kernels know its size to a few 1e-4 there
CLOSE = 1e-9  # of a parameter or of c_z, which are compared as they are
BUDGETS = (1e-3, 1e-6, 1e-9)
R = 0.03125  # of the envelope


@dataclass
class Drawn:
    """States of collisions that are to be put at a threshold."""

    slips: Array  # c_x, c_z, s_x, s_y
    u_b: Array
    u_s: Array
    e_b: Array


def drawn(model: str) -> Drawn:
    rng = np.random.default_rng(11)
    within = envelope(find_scene("any"), model, "scene")
    turn, way = rng.uniform(0.1, 3.0, PAIRS), rng.uniform(0, 2 * np.pi, PAIRS)
    c, s = 10 ** rng.uniform(-1.5, 0.5, PAIRS), 10 ** rng.uniform(-1.5, 0.5, PAIRS)
    slips = np.stack([c * np.cos(turn), -c * np.sin(turn), s * np.cos(way), s * np.sin(way)])
    draws = (rng.uniform(low, high, PAIRS) for low, high in (within.u_b, within.u_s, within.e_b))
    return Drawn(slips, *draws)


Constants = dict[str, float]
Put = Callable[[Drawn, Constants, float], None]  # states at `side` times a threshold


def _friction(at: Drawn) -> Array:
    return at.u_s * at.u_b * np.abs(at.slips[1]) / np.hypot(at.slips[0], at.slips[1])


def _at_size(slips: Array, size: Array) -> None:
    slips *= size / np.hypot(*slips)


def rest(at: Drawn, k: Constants, side: float) -> None:
    """Table slip that counts as none."""
    _at_size(at.slips[2:], side * k["kRest"] * k["kTolerance"] / _friction(at))


def settled(at: Drawn, k: Constants, side: float) -> None:
    """Table slip that is taken away where it counts as none."""
    at.u_s[:] = np.minimum(at.u_s, 0.2 / at.u_b)
    _at_size(at.slips[2:], side * np.full(PAIRS, k["kSettled"] * k["kTolerance"]))


def gone(at: Drawn, k: Constants, side: float) -> None:
    """Contact slip that counts as gone."""
    _at_size(at.slips[:2], side * np.full(PAIRS, k["kGone"] * k["kTolerance"]))


def little_bounce(at: Drawn, k: Constants, side: float) -> None:
    """Restitution below which order 7 takes its work by parts."""
    at.e_b[:] = k["kLittleBounce"] * side


def no_bounce(at: Drawn, k: Constants, side: float) -> None:
    """None at all, and hardly any."""
    at.e_b[:] = 0.0 if side < 1 else 1e-300


def press(at: Drawn, k: Constants, side: float) -> None:
    """Vertical slip up to which no ball is pressed."""
    at.slips[1] = -k["kNoPress"] * side * np.abs(at.slips[0])
    at.slips[3] = 0.0  # so that no other spin of ball 1 is there, in which c_z would be lost


def rubs(at: Drawn, k: Constants, side: float) -> None:
    """Friction between the balls up to which there is none."""
    at.u_b[:] = 1e-30 * side


def table(at: Drawn, k: Constants, side: float) -> None:
    """Table friction that is of account to a step over all of the collision."""
    at.u_s[:] = side * k["kCounts"] * k["kTolerance"] / (at.u_b * (1 + at.e_b) / 2)
    at.u_s[:] = np.minimum(at.u_s, 1.0)


NOT_IN_ALL = {settled: "kSettled", little_bounce: "kLittleBounce"}  # orders have them

# How far results may jump, in budgets, and how far apart the two sides are.
PUT: tuple[tuple[Put, float, float], ...] = (
    (rest, 0.5, BESIDE),
    (settled, 0.5, BESIDE),
    (gone, 0.01, BESIDE),
    (table, 0.01, BESIDE),
    (little_bounce, 0.01, CLOSE),
    (no_bounce, 0.01, CLOSE),
    (press, 0.05, CLOSE),
    (rubs, 0.05, CLOSE),
)


def constants(text: str) -> Constants:
    return {
        name: float(value)
        for name, value in re.findall(r"constexpr double (k\w+) =\s*([-+.\de]+);", text)
    }


def cases_beside(model: str, put: Put, of: Constants, side: float) -> Array:
    at = drawn(model)
    put(at, of, side)
    states = States(at.slips, at.u_b, at.u_s, at.e_b)
    layout = Layout(False, 0.0, 0.0, True, 1.0)
    return cases_of(states, layout, envelope(find_scene("any"), model, "scene"))


def off(library: Path, model: str, cases: Array) -> Array:
    """Errors with their signs, of v and R w; the balls approach with 1 m/s."""
    wrong = (
        bench_tool().run_kernel(library, cases)
        - bench_tool().expect(cases, "screen", model)[:, :13]
    )
    wrong[:, [3, 4, 5, 9, 10, 11]] *= R
    return wrong


@pytest.mark.parametrize("model", MODELS)
def test_both_sides_of_a_threshold_agree(model: str) -> None:
    variants = [exact_variant(model, budget) for budget in BUDGETS]
    met = set()
    for budget, variant, library in zip(BUDGETS, variants, built(variants), strict=True):
        of = constants(emit(variant).source)
        for put, most, beside in PUT:
            if NOT_IN_ALL.get(put, "kGone") not in of:
                continue
            met.add(put)
            below, above = (
                off(library, model, cases_beside(model, put, of, 1 + side * beside))
                for side in (-1, 1)
            )
            jump = np.abs(above - below).max() / budget
            print(f"{model} {budget:g} {put.__name__}: jump of {jump:.2g} budgets")
            assert jump <= most
            assert (above[:, 12] == below[:, 12]).all()
    assert met == {put for put, _, _ in PUT if model != "pooltool" or put is not settled}
