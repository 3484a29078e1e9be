"""The oracle of a ball and a cushion: closed forms, the paper's figures, and what always holds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from generator.evidence.timing.bench_tool import BenchTool
from generator.evidence.verification.errors import Array
from generator.impacts.ball_cushion.columns import COLUMNS
from tests.support.cushion import cushion_tool

DIGITS = 1e-12  # of the largest speed
PAPER = (0.02625, 0.1406, 0.212, 0.14, 0.98, 1.4 * 0.02625)
POOL = (0.028575, 0.170097, 0.2, 0.2, 0.85, 1.28 * 0.028575)
RANDOM, SEED = 860, 90125
OK, SEPARATING, BAD_INPUT = 0, 1, 2
V, W, N = slice(6, 9), slice(9, 12), slice(12, 14)


@pytest.fixture(scope="module")
def tool() -> BenchTool:
    return cushion_tool()


@pytest.fixture(scope="module")
def cases(tool: BenchTool) -> Array:
    return tool.make_cases(SEED, RANDOM, mixed=False).rows


@pytest.fixture(scope="module")
def outcomes(tool: BenchTool, cases: Array) -> Array:
    return solve(tool, cases)


def solve(tool: BenchTool, rows: Array, model: str = "clamped", status: int = OK) -> Array:
    found = tool.expect(np.atleast_2d(rows), "exact", model)
    assert (found[:, COLUMNS.status] == status).all()
    return found[:, : len(COLUMNS.velocities)]


def shot(parameters: tuple[float, ...], v: tuple[float, float], r_w: tuple[float, ...]) -> Array:
    """Into a cushion along y, so that x and y are the frame's; `r_w`: R w."""
    return np.array([*parameters, *v, 0.0, *(w / parameters[0] for w in r_w), 0.0, 1.0])


def sizes(rows: Array) -> Array:
    return np.maximum(np.abs(rows[:, V]).max(axis=1), rows[:, 0] * np.abs(rows[:, W]).max(axis=1))


def errors(rows: Array, got: Array, want: Array) -> Array:
    """Of the largest speed before."""
    scale = np.column_stack([np.ones((len(rows), 3)), np.repeat(rows[:, :1], 3, axis=1)])
    return np.abs((got - want) * scale).max(axis=1) / sizes(rows)


@dataclass(frozen=True)
class Straight:
    """Constant rates of a shot straight into a cushion, by the signs of its slips."""

    parameters: tuple[float, ...]

    @property
    def angles(self) -> tuple[float, float]:
        sine = self.parameters[5] / self.parameters[0] - 1
        return sine, math.sqrt(1 - sine**2)

    @property
    def frictions(self) -> tuple[float, float, float]:
        return self.parameters[2], self.parameters[3], self.parameters[4]

    def press(self, d_z: float) -> float:
        sine, cosine = self.angles
        return max(0.0, sine - cosine * d_z)

    def held(self, way: float) -> tuple[float, float]:
        """d_z and t_y where the nose sticks and the table slips up (1) or down (-1)."""
        (sine, cosine), u_s = self.angles, self.frictions[0]
        press = 3.5 * sine / (2.5 + sine**2 + (2.5 - sine) * u_s * cosine * way)
        return (sine - press) / cosine, -u_s * press * way

    def slowing(self, d_z: float, t_y: float) -> float:
        """-v_y' per q."""
        sine, cosine = self.angles
        return cosine + sine * d_z - t_y


def rolls_back(parameters: tuple[float, ...]) -> float | None:
    """v'/v of a ball that rolls straight into a cushion; None where the form does not hold."""
    law = Straight(parameters)
    (sine, cosine), (u_s, u_w, e) = law.angles, law.frictions
    slips = 3.5 * u_s * law.press(u_w) < cosine - (2.5 - sine) * u_w
    pull = u_s * law.press(u_w)
    k = law.slowing(u_w, pull)
    gone = (1 + sine) / (sine * cosine + (2.5 + sine**2) * u_w + (2.5 - sine) * pull)
    if not slips or gone < 1 / k:
        return None
    if gone >= (1 + e) / k:
        return e
    d_z, t_y = law.held(-1)
    if abs(d_z) > u_w:
        d_z, t_y = -u_w, u_s * law.press(-u_w)
    k2, v1 = law.slowing(d_z, t_y), 1 - k * gone
    return math.sqrt(v1**2 * (1 - k2 / k) + e**2 * k2 / k)


def random_parameters(count: int) -> list[tuple[float, ...]]:
    rng = np.random.default_rng(SEED)
    low, high = [0.025, 0.13, 0.0, 0.0, 0.3, 1.0], [0.035, 0.3, 0.5, 0.4, 1.0, 1.5]
    drawn = rng.uniform(low, high, (count, 6))
    drawn[:, 5] *= drawn[:, 0]
    return [tuple(float(x) for x in row) for row in drawn]


def test_a_straight_roll_comes_back_as_its_closed_form_says(tool: BenchTool) -> None:
    known = [(p, rolls_back(p)) for p in (PAPER, POOL, *random_parameters(400))]
    held = [(p, ratio) for p, ratio in known if ratio is not None]
    found = solve(tool, np.array([shot(p, (0, 1), (-1, 0, 0)) for p, _ in held]))
    off = np.abs(-found[:, 1] - [ratio for _, ratio in held])
    print(f"straight rolls: {off.max():.2g} in {len(held)} of {len(known)} cases")
    assert len(held) > 200
    assert off.max() <= DIGITS
    assert -found[0, 1] == pytest.approx(0.9106577416984531, abs=1e-15)
    assert -found[1, 1] == pytest.approx(0.8042818992213045, abs=1e-15)


def test_a_nose_that_sticks_all_through_has_a_closed_form(tool: BenchTool) -> None:
    """Straight, c = 0: both slips are zero at greatest compression, where the table's turns."""
    dyadic = (1 / 32, 0.2, 0.2, 0.5, 0.85, 1.5 / 32)
    rows, want = [], []
    for p in (dyadic, *random_parameters(400)):
        law = Straight(p)
        (up, pull_up), (down, pull_down) = law.held(1), law.held(-1)
        if max(abs(up), abs(down)) < law.frictions[1]:
            slowings = law.slowing(up, pull_up), law.slowing(down, pull_down)
            rows.append(shot(p, (0, 1), (law.angles[0], 0, 0)))
            want.append(law.frictions[2] * math.sqrt(slowings[1] / slowings[0]))
    off = np.abs(-solve(tool, np.array(rows))[:, 1] - want)
    print(f"noses that stick: {off.max():.2g} in {len(rows)} cases")
    assert len(rows) > 50
    assert off.max() <= DIGITS
    assert want[0] == pytest.approx(0.6721743617775072, abs=1e-15)


def test_without_friction_only_the_approach_turns_round(tool: BenchTool, cases: Array) -> None:
    rows = cases[cases[:, 2] + cases[:, 3] == 0]
    n = rows[:, N] / np.linalg.norm(rows[:, N], axis=1)[:, None]
    want = rows[:, 6:12].copy()
    want[:, :2] -= (1 + rows[:, 4:5]) * (rows[:, 6:8] * n).sum(axis=1)[:, None] * n
    off = errors(rows, solve(tool, rows), want)
    print(f"frictionless: {off.max():.2g} in {len(rows)} cases")
    assert len(rows) >= 20
    assert off.max() <= DIGITS


def test_a_level_nose_without_draw_has_a_closed_form(tool: BenchTool) -> None:
    """h = R, w_x = 0: friction along x alone, until the slip ends."""
    rng = np.random.default_rng(3)
    rows, want = [], []
    for p in random_parameters(200):
        p = (*p[:5], p[0])
        v, r_w = (rng.uniform(-2, 2), 1.0), (0.0, rng.uniform(-1, 1), rng.uniform(-3, 3))
        slip = v[0] - r_w[2]
        dv = -math.copysign(min(p[3] * (1 + p[4]), 2 / 7 * abs(slip)), slip)
        rows.append(shot(p, v, r_w))
        want.append(shot(p, (v[0] + dv, -p[4]), (0.0, r_w[1], r_w[2] - 2.5 * dv))[6:12])
    off = errors(np.array(rows), solve(tool, np.array(rows)), np.array(want))
    print(f"level nose: {off.max():.2g} in {len(rows)} cases")
    assert off.max() <= DIGITS


# Speed V, degrees from the cushion's line, top spin and side spin in V/R; then the speed after in V
# and degrees as read off the paper's Figs. 8 and 10, and exactly.
FIGURES = (
    (1.0, 90, 1, 0, 0.912, None, 0.9107, None),
    (1.0, 44, 1, 0, 0.847, None, 0.8472, None),
    (1.0, 90, 0, 0, 0.838, None, 0.8373, None),
    (1.0, 44, 0, 0, 0.757, None, 0.7563, None),
    (1.0, 90, -1, 0, 0.868, None, 0.8659, None),
    (1.0, 40, -1, 0, 0.799, None, 0.7976, None),
    (1.0, 44, 1, 2, 1.116, None, 1.1157, None),
    (1.0, 90, 1, 1, 0.968, 76.3, 0.9676, 76.07),
    (1.0, 90, 1, -2, 1.003, 107, 1.0019, 106.86),
    (1.0, 26, 1, 1, 0.905, None, 0.9042, None),
    (2.5, 90, 1, 0, 2.28 / 2.5, None, 2.2766 / 2.5, None),
)


@pytest.mark.parametrize("figure", FIGURES)
def test_the_papers_figures(tool: BenchTool, figure: tuple[float, ...]) -> None:
    speed, degrees, top, side, read, read_angle, ratio, angle = figure
    along, into = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    v, r_w = (speed * along, speed * into), (-top * speed * into, top * speed * along, side * speed)
    found = solve(tool, shot(PAPER, v, r_w))[0]
    after = math.hypot(found[0], found[1]) / speed
    turned = math.degrees(math.atan2(-found[1], found[0]))
    print(f"{degrees} degrees, spins {top}, {side}: {after:.4f} {turned:.2f}, read off {read:.4g}")
    assert after == pytest.approx(ratio, abs=0.5001e-4)
    assert after == pytest.approx(read, abs=3e-3)
    if angle is not None:
        assert turned == pytest.approx(angle, abs=0.5001e-2)
        assert turned == pytest.approx(read_angle, abs=0.5)


def test_kinetic_energy_never_grows(cases: Array, outcomes: Array) -> None:
    weight = 0.4 * cases[:, 0] ** 2
    before, after = (
        (v[:, :3] ** 2).sum(axis=1) + weight * (v[:, 3:] ** 2).sum(axis=1)
        for v in (cases[:, 6:12], outcomes)
    )
    growth = (after / before - 1).max()
    print(f"largest growth {growth:.2g} in {len(cases)} cases")
    assert growth <= DIGITS


def test_an_invariant_stays(cases: Array, outcomes: Array) -> None:
    """R w_y + 5/2 v_x + (1 + S)/C R w_z, whatever the friction."""
    sine = cases[:, 5] / cases[:, 0] - 1
    n = cases[:, N] / np.linalg.norm(cases[:, N], axis=1)[:, None]

    def kept(v: Array) -> Array:
        v_x = v[:, 0] * n[:, 1] - v[:, 1] * n[:, 0]
        w_y = (v[:, 3:5] * n).sum(axis=1)
        spin = w_y + (1 + sine) / np.sqrt(1 - sine**2) * v[:, 5]
        return 2.5 * v_x + cases[:, 0] * spin

    off = np.abs(kept(outcomes) - kept(cases[:, 6:12])) / sizes(cases)
    print(f"invariant: {off.max():.2g} in {len(cases)} cases")
    assert off.max() <= DIGITS


def well_posed(rows: Array, model: str) -> Array:
    """Rows whose outcome does not follow the rounding of the input."""
    return rows if model == "clamped" else rows[rows[:, 3] < 0.9 * _tangent(rows)]


def _tangent(rows: Array) -> Array:
    sine = rows[:, 5] / rows[:, 0] - 1
    tangent: Array = sine / np.sqrt(1 - sine**2)
    return tangent


@pytest.mark.parametrize("model", ["clamped", "printed"])
def test_mirrored_impacts_end_mirrored(tool: BenchTool, cases: Array, model: str) -> None:
    rows = well_posed(cases, model)
    mirrored = rows * [*[1] * 6, -1, 1, 1, 1, -1, -1, -1, 1]  # x to -x: all spins turn but w_x
    got, want = solve(tool, mirrored, model), solve(tool, rows, model) * [-1, 1, 1, 1, -1, -1]
    off = errors(rows, got, want)
    print(f"{model}: {off.max():.2g} in {len(rows)} cases")
    assert off.max() <= DIGITS


def test_turned_impacts_end_turned(tool: BenchTool, cases: Array, outcomes: Array) -> None:
    def turned(v: Array, at: int) -> None:
        v[:, at], v[:, at + 1] = -v[:, at + 1].copy(), v[:, at].copy()

    rows, want = cases.copy(), outcomes.copy()
    for at in (6, 9, 12):
        turned(rows, at)
    for at in (0, 3):
        turned(want, at)
    off = errors(rows, solve(tool, rows), want)
    print(f"a quarter turn: {off.max():.2g} in {len(rows)} cases")
    assert off.max() <= DIGITS


@pytest.mark.parametrize("power", [-600, -20, 40, 300])
def test_speeds_scale_together(tool: BenchTool, cases: Array, outcomes: Array, power: int) -> None:
    rows = cases.copy()
    rows[:, 6:12] *= 2.0**power
    off = errors(rows, solve(tool, rows), outcomes * 2.0**power)
    print(f"times 2^{power}: {off.max():.2g}")
    assert off.max() == 0


def test_neither_mass_nor_the_length_of_the_normal_counts(
    tool: BenchTool, cases: Array, outcomes: Array
) -> None:
    rows = cases.copy()
    rows[:, 1] *= 3
    rows[:, N] *= 2.0**-500
    assert (solve(tool, rows) == outcomes).all()


@pytest.mark.parametrize("spin", [1.0, 0.0, -0.7])
def test_the_rebound_is_the_same_at_any_speed(tool: BenchTool, spin: float) -> None:
    speeds = np.geomspace(1e-6, 50, 60)
    rows = np.array(
        [shot(POOL, (0.5 * v, v), (-spin * v, 0.5 * spin * v, 0.3 * v)) for v in speeds]
    )
    ratios = solve(tool, rows)[:, :2] / speeds[:, None]
    spread = np.ptp(ratios, axis=0).max()
    print(f"spin {spin}: {ratios[0]}, spread {spread:.2g} from 1e-6 to 50 m/s")
    assert spread <= DIGITS


BAD = {
    "leaves": (SEPARATING, {7: -1.0}),
    "passes along": (SEPARATING, {6: 1.0, 7: 0.0}),
    "rests": (SEPARATING, {7: 0.0, 9: 0.0}),
    "a speed is no number": (BAD_INPUT, {6: math.nan}),
    "a spin is infinite": (BAD_INPUT, {10: math.inf}),
    "the normal is zero": (BAD_INPUT, {13: 0.0}),
    "the normal is no number": (BAD_INPUT, {12: math.nan}),
    "no radius": (BAD_INPUT, {0: 0.0}),
    "no mass": (BAD_INPUT, {1: 0.0}),
    "friction below 0": (BAD_INPUT, {2: -0.1}),
    "friction above 1": (BAD_INPUT, {3: 1.1}),
    "restitution above 1": (BAD_INPUT, {4: 1.01}),
    "no height": (BAD_INPUT, {5: 0.0}),
    "nose below the centre": (BAD_INPUT, {5: 0.99 * POOL[0]}),
    "nose on top": (BAD_INPUT, {5: 2 * POOL[0]}),
    "it jams": (BAD_INPUT, {2: 0.6, 3: 0.9, 5: 1.7 * POOL[0]}),
}


@pytest.mark.parametrize("name", BAD)
def test_without_an_impact_velocities_stay_and_the_status_says_so(
    tool: BenchTool, name: str
) -> None:
    status, changes = BAD[name]
    row = shot(POOL, (0, 1), (-1, 0, 0))
    for at, value in changes.items():
        row[at] = value
    for model in ("clamped", "printed"):
        assert np.array_equal(solve(tool, row, model, status)[0], row[6:12], equal_nan=True)


def test_the_same_seed_deals_the_same_cases_of_every_kind(tool: BenchTool) -> None:
    made, again = (tool.make_cases(3, 430, mixed=False) for _ in range(2))
    assert (made.rows == again.rows).all()
    assert len(set(made.kinds)) == 43
    assert (tool.make_cases(4, 430, mixed=False).rows != made.rows).any()
    mixed = tool.make_cases(3, 990)
    ordinary = set(made.kinds[:10])
    share = sum(kind in ordinary for kind in mixed.kinds) / len(mixed.kinds)
    print(f"{share:.2f} of the mixture are ordinary shots")
    assert 0.6 < share < 0.7


def test_every_case_is_an_impact_that_the_oracle_solves(tool: BenchTool, cases: Array) -> None:
    for model in ("clamped", "printed"):
        found = tool.expect(cases, "exact", model)
        assert (found[:, COLUMNS.status] == OK).all()
        assert (found[:, COLUMNS.sticks] < 2).all()
        assert np.isfinite(found).all()


def test_double_and_long_double_agree(tool: BenchTool, cases: Array, outcomes: Array) -> None:
    off = errors(cases, tool.expect(cases, "screen", "clamped")[:, :6], outcomes)
    print(f"double: {off.max():.2g} in {len(cases)} cases")
    assert off.max() <= DIGITS
