"""The predicted values of the paper's Tables 1 and 2, every printed digit.

After the collision both balls slide until they roll, by the usual law: five sevenths of the speed
and two sevenths of that at which the spin would roll. Angles are from the cue ball's first path.
"""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest

from generator.evidence.verification.errors import Array
from tests.support.exact_kernels import built, exact_variant, fixed_step_variant
from tests.support.kernels import bench_tool

R, M, E_B, U_B, U_S = 0.02625, 0.1406, 0.89, 0.05, 0.21
STEPS = 5000
# V (m/s), w (rad/s), cut (degrees); speeds (m/s) of cue ball and object ball, their angles
TABLES = (
    ((1.539, 58.63, 33.83), ("0.914", "0.831", "31.93", "32.20")),
    ((1.032, 39.31, 26.36), ("0.520", "0.599", "32.45", "25.07")),
    ((1.364, 51.96, 40.52), ("0.917", "0.676", "29.91", "38.62")),
    ((1.731, 65.94, 46.50), ("1.28", "0.780", "27.32", "44.38")),
    ((0.942, 35.89, 18.05), ("0.383", "0.579", "29.47", "17.15")),
)


def cases() -> Array:
    """The cue ball rolls along y; the line of centres is turned from it by the cut."""
    rows = []
    for (speed, spin, cut), _ in TABLES:
        x, y = np.sin(np.radians(cut)), np.cos(np.radians(cut))
        one = [0, 0, R, 0, speed, 0, -spin, 0, 0]
        two = [2 * R * x, 2 * R * y, R, 0, 0, 0, 0, 0, 0]
        rows.append([R, M, U_S, U_S, U_B, E_B, *one, *two])
    return np.array(rows, dtype=np.float64)


def rolling(v: Array, w: Array) -> Array:
    """Velocity once sliding has ended."""
    return 5 / 7 * v[:2] + 2 / 7 * R * np.array([w[1], -w[0]])


def predicted(outcome: Array) -> tuple[float, float, float, float]:
    cue, ball = rolling(outcome[0:3], outcome[3:6]), rolling(outcome[6:9], outcome[9:12])
    angles = [abs(float(np.degrees(np.arctan2(v[0], v[1])))) for v in (cue, ball)]
    assert cue[0] < 0 < ball[0]  # to either side of the first path
    return float(np.hypot(*cue)), float(np.hypot(*ball)), angles[0], angles[1]


def printed(value: float, like: str) -> str:
    """With as many decimals as the paper prints."""
    return str(Decimal(value).quantize(Decimal(like)))


def mismatches(outcomes: Array) -> list[str]:
    wrong = []
    for ((speed, _, cut), want), outcome in zip(TABLES, outcomes, strict=True):
        values = predicted(outcome)
        got = tuple(printed(v, w) for v, w in zip(values, want, strict=True))
        print(f"{speed} m/s, {cut} degrees:", " ".join(f"{v:.5f}" for v in values), "->", *got)
        wrong += [f"{g} for {w}" for g, w in zip(got, want, strict=True) if g != w]
    return wrong


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_fixed_steps_give_every_printed_digit(compiler: str) -> None:
    library = built([fixed_step_variant("mathavan2014", compiler)])[0]
    assert mismatches(bench_tool().run_kernel(library, cases(), steps=STEPS)) == []


def test_fewer_and_more_steps_do_not() -> None:
    """The last digits are those of 5000 steps: what the paper prints is 0.02 degrees from exact."""
    library = built([fixed_step_variant("mathavan2014")])[0]
    for steps in (1000, 2500, 20_000, 100_000):
        wrong = mismatches(bench_tool().run_kernel(library, cases(), steps=steps))
        print(f"{steps} steps: {len(wrong)} of 20 differ: {', '.join(wrong)}")
        assert 1 <= len(wrong) <= 6


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("budget", [1e-6, 1e-9])
def test_the_exact_kernel_is_off_by_the_papers_steps_alone(compiler: str, budget: float) -> None:
    """Printed digits are those of the limit, but for the error of the paper's 5000 steps."""
    tool = bench_tool()
    library = built([exact_variant("mathavan2014", budget, compiler)])[0]
    got, exact = tool.run_kernel(library, cases()), tool.expect(cases(), "exact", "mathavan2014")
    steps = tool.expect(cases(), "euler", "mathavan2014", STEPS)
    wrong = mismatches(got)
    print(f"{len(wrong)} of 20 differ: {', '.join(wrong)}")
    assert wrong == mismatches(exact)
    for (_, want), g, x, s in zip(TABLES, got, exact, steps, strict=True):
        rows = zip(want, predicted(g), predicted(x), predicted(s), strict=True)
        for text, value, limit, stepped in rows:
            # 1e-6 of 1.7 m/s turns the slowest ball, .38 m/s, by 1e-4 degrees.
            assert value == pytest.approx(limit, abs=500 * budget)
            assert printed(stepped, text) == text
            unit = 10.0 ** int(Decimal(text).as_tuple().exponent)
            assert abs(value - float(text)) <= 0.5 * unit + abs(stepped - limit) + 500 * budget


@pytest.mark.parametrize("model", ["bottom_slip", "pooltool"])
def test_other_models_do_not(model: str) -> None:
    """The digits tell the models apart."""
    library = built([exact_variant(model, 1e-6)])[0]
    wrong = mismatches(bench_tool().run_kernel(library, cases()))
    print(f"{model}: {len(wrong)} of 20 differ: {', '.join(wrong)}")
    assert len(wrong) >= 2
