"""Results are smooth in the inputs: second differences along sweeps stay within the budget.

Of three neighbours in a sweep each is within E |v1 - v2| of the exact result, so their second
difference is within 4 E |v1 - v2| of the exact one, which is small: the sweep's step squared, or
the step where the exact result has a kink (a contact just sticks, the other ball is pressed).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from generator.evidence.verification.errors import Array
from generator.impacts.ball_ball.evidence.measure import relative_speed
from tests.support.exact_kernels import (
    MODELS,
    built,
    exact_variant,
    fixed_step_variant,
    hexfloats,
    shot,
)
from tests.support.kernels import bench_tool
from tests.support.oracle_cache import expected_of

R = 0.028575
PARAMS = (R, 0.170097, 0.2, 0.2, 0.06, 0.95)
STEPS = 10_000
LARGEST_KINK = 4e-4  # second difference of the exact result; its slope times the sweep's step


@dataclass(frozen=True)
class Sweep:
    """Cases in the order of one input."""

    name: str
    rows: Array


def aimed(cut: float, spin: float, side: float, v2: tuple[float, ...] = (0.0, 0.0, 0.0)) -> Array:
    """A shot at 1 m/s: topspin (1 rolls) and side as shares of the speed."""
    x, y = np.sin(np.radians(cut)), np.cos(np.radians(cut))
    w1 = np.array([-spin * y, spin * x, side]) / R
    w2 = np.array([-v2[1], v2[0], 0.0]) / R
    return shot(v1=(x, y, 0), w1=tuple(w1), v2=v2, w2=tuple(w2), params=PARAMS)


def sweeps() -> list[Sweep]:
    spins = np.linspace(-1.5, 1.5, STEPS)
    cuts = np.linspace(0.0, 89.9, STEPS)
    rolls = (0.1, -0.3, 0.0)
    return [
        Sweep("topspin, half-ball", np.array([aimed(30, s, 0) for s in spins])),
        Sweep("topspin, with side", np.array([aimed(20, s, 0.4) for s in spins])),
        Sweep("topspin, rolling object ball", np.array([aimed(40, s, 0, rolls) for s in spins])),
        Sweep("topspin, gearing", np.array([aimed(30, s, 0.5) for s in spins])),
        Sweep("cut, rolling", np.array([aimed(c, 1, 0) for c in cuts])),
        Sweep("cut, stun", np.array([aimed(c, 0, 0) for c in cuts])),
        Sweep("cut, draw with side", np.array([aimed(c, -0.8, 0.3) for c in cuts])),
    ]


def speeds(rows: Array, got: Array) -> Array:
    """v1, R w1, v2, R w2."""
    values = got[:, :12].copy()
    values[:, [3, 4, 5, 9, 10, 11]] *= rows[:, :1]
    return values


def second_differences(rows: Array, got: Array) -> Array:
    """As a share of the relative speed, of every output."""
    values = speeds(rows, got)
    bends = values[2:] - 2 * values[1:-1] + values[:-2]
    return bends / relative_speed(rows)[1:-1, None]


def check(model: str, budgets: tuple[float, ...], chosen: list[Sweep]) -> None:
    """Kernels are smooth on each sweep, and the fixed-step scheme is not."""
    tool = bench_tool()
    *libraries, fixed = built(
        [*(exact_variant(model, budget) for budget in budgets), fixed_step_variant(model)]
    )
    for sweep in chosen:
        rows = sweep.rows
        exact = second_differences(rows, expected_of(tool, rows, model))
        assert np.abs(exact).max() <= LARGEST_KINK
        euler = second_differences(rows, tool.run_kernel(fixed, rows))
        jump = np.abs(euler - exact).max()
        print(f"{model}, {sweep.name}: exact {np.abs(exact).max():.2g}, N=1000 {jump:.2g} from it")
        assert jump >= 2e-4, "fixed steps jump; if they do not, this test does not see jumps"
        for budget, library in zip(budgets, libraries, strict=True):
            kernel = second_differences(rows, tool.run_kernel(library, rows))
            off = np.abs(kernel - exact)
            i, bound = int(off.max(axis=1).argmax()), 4 * budget
            print(f"  E = {budget:g}: {off.max():.2g} from it, of {bound:.2g}")
            assert off[i].max() <= bound, "\n".join(hexfloats(rows[i + k]) for k in range(3))
            assert jump > bound


def test_sweeps_are_smooth() -> None:
    chosen = [s for s in sweeps() if s.name in ("topspin, half-ball", "cut, rolling")]
    check("mathavan2014", (1e-6,), chosen)


@pytest.mark.long
@pytest.mark.parametrize("model", MODELS)
def test_all_sweeps_are_smooth(model: str) -> None:
    check(model, (1e-6, 1e-9), sweeps())
