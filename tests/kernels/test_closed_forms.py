"""Collisions that have closed forms, and what every collision must keep, for kernels and oracle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
import pytest

from generator.evidence.timing.bench_tool import BenchTool
from generator.evidence.verification.errors import Array
from generator.impacts.ball_ball.evidence.measure import STATUS, errors_of, relative_speed
from tests.support.exact_kernels import MODELS, M, R, built, exact_variant, hexfloats, shot
from tests.support.kernels import bench_tool

BOTTOM = ("mathavan2014", "bottom_slip")
ORACLE = 0.0  # in place of a budget
FAST = (ORACLE, 1e-6)
LONG = (1e-3, 1e-4, 1e-9, 1e-12)
ROUNDING = 1e-14  # of the largest speed
RANDOM, SEED = 1700, 90125


@dataclass(frozen=True)
class Solver:
    """Something that solves cases: the kernel for a budget, or the oracle."""

    model: str
    budget: float
    run: Callable[[Array], Array]

    @property
    def tolerance(self) -> float:
        """Of the relative speed."""
        return self.budget + 2e-14

    @property
    def lifts(self) -> bool:
        return self.model == "mathavan2014"


@pytest.fixture(scope="module")
def tool() -> BenchTool:
    return bench_tool()


def _param(model: str, budget: float):
    marks = [pytest.mark.long] if budget in LONG else []
    return pytest.param((model, budget), marks=marks, id=f"{model}-{budget or 'oracle'}")


@pytest.fixture(scope="module", params=[_param(m, b) for m in MODELS for b in (*FAST, *LONG)])
def solver(request: pytest.FixtureRequest, tool: BenchTool) -> Solver:
    model, budget = request.param
    if budget == ORACLE:
        return Solver(model, budget, lambda cases: tool.expect(cases, "exact", model)[:, :13])
    library = built([exact_variant(model, budget)])[0]
    return Solver(model, budget, lambda cases: tool.run_kernel(library, cases))


@pytest.fixture(scope="module")
def cases(tool: BenchTool) -> Array:
    return tool.make_cases(SEED, RANDOM, mixed=False).rows


def check(solver: Solver, cases: list[Array], want: list[list[float]], what: str) -> None:
    """`want`: v1, R w1, v2, R w2 of each case."""
    rows = np.array(cases)
    expected = np.zeros((len(rows), 13))
    expected[:, :12] = want
    for columns in ((3, 4, 5), (9, 10, 11)):
        expected[:, columns] /= rows[:, :1]
    got = solver.run(rows)
    assert (got[:, STATUS] == 0).all()
    relative = errors_of(rows, got, expected).relative
    i = int(relative.argmax())
    print(f"{what}, {solver.model} {solver.budget:g}: {relative[i]:.3g} in {len(rows)} cases")
    assert relative[i] <= solver.tolerance, (hexfloats(rows[i]), got[i], expected[i])


def slips(solver: Solver, spin: float, q: float, P_per_V: float, u_b: float) -> bool:
    """Does contact slip last to the end, head-on? c_z falls by 5 (6 with lift) u_b and 5/2 q."""
    return ((6 if solver.lifts else 5) * u_b + 2.5 * q) * P_per_V < 0.999 * spin


def settings() -> list[tuple[float, float, float, float]]:
    """Speed, e_b, u_b, u_s."""
    return list(product((0.01, 1.0, 7.5), (0.0, 0.5, 0.95, 1.0), (0.01, 0.06, 0.12), (0.0, 0.2, 1)))


# -- closed forms ----------------------------------------------------------------------------------


def test_head_on_with_topspin(solver: Solver) -> None:
    cases, want = [], []
    for V, e, u_b, u_s in settings():
        for spin in (0.75, 1.0, 1.4):
            q = u_s * u_b
            P = (1 + e) * V / (2 - q)
            if not slips(solver, spin, -q, P / V, u_b):
                continue
            params = (R, M, 0.5 * u_s, u_s, u_b, e)
            cases.append(shot(v1=(0, V, 0), w1=(-spin * V / R, 0, 0), params=params))
            up = u_b * P if solver.lifts else 0.0
            first = (0, V - P, up, -spin * V + 2.5 * u_b * P, 0, 0)
            second = (0, (1 - q) * P, 0, 2.5 * (u_b - q) * P, 0, 0)
            want.append([*first, *second])
    check(solver, cases, want, "head-on roll")


def test_head_on_full_draw(solver: Solver) -> None:
    if solver.model not in BOTTOM:
        pytest.skip("the closed form holds for the bottom slip")
    cases, want = [], []
    for V, e, u_b, u_s in settings():
        for spin in (0.75, 1.0, 1.4):
            q = u_s * u_b
            P = (1 + e) * V / (2 + q)
            if not slips(solver, spin, q, P / V, u_b):
                continue
            params = (R, M, u_s, 0.5 * u_s, u_b, e)
            cases.append(shot(v1=(0, V, 0), w1=(spin * V / R, 0, 0), params=params))
            up = u_b * P if solver.lifts else 0.0
            first = (0, V - (1 + q) * P, 0, spin * V - 2.5 * (u_b + q) * P, 0, 0)
            second = (0, P, up, -2.5 * u_b * P, 0, 0)
            want.append([*first, *second])
    check(solver, cases, want, "head-on draw")


def test_stun_and_side(solver: Solver) -> None:
    """Alciatore's TP A.14 with (1 + e)/2: slipping or sticking, whatever the table."""
    cases, want, stuck = [], [], 0
    for V, e, u_b, u_s in settings():
        for cut, side in product((0.05, 20, 45, 70, 88), (-1.0, 0.0, 0.3, 0.9)):
            v_x, v_n = V * np.sin(np.radians(cut)), V * np.cos(np.radians(cut))
            c_x = v_x - side * V
            sticks = u_b * v_n * (1 + e) / 2 > abs(c_x) / 7
            stuck += sticks
            v_t = c_x / 7 if sticks else np.copysign(u_b * v_n * (1 + e) / 2, c_x)
            P = v_n * (1 + e) / 2
            params = (R, M, u_s, u_s, u_b, e)
            cases.append(shot(v1=(v_x, v_n, 0), w1=(0, 0, side * V / R), params=params))
            first = (v_x - v_t, v_n - P, 0, 0, 0, side * V + 2.5 * v_t)
            want.append([*first, v_t, P, 0, 0, 0, 2.5 * v_t])
    assert 0.05 * len(cases) < stuck < 0.95 * len(cases)
    check(solver, cases, want, f"stun and side, {stuck} stick")


def test_spin_transfer_when_sticking(solver: Solver) -> None:
    """TP A.27: a ball with side alone that sticks gives away 5/14 of its spin."""
    for side in (-3.0, 0.2, 11.0):
        row = shot(v1=(0, 1, 0), w1=(0, 0, side), params=(R, M, 0.2, 0.2, 0.5, 0.95))
        got = solver.run(row[None])[0]
        share = -got[11] / side
        print(f"{solver.model} {solver.budget:g}: {share!r} for 5/14 = {5 / 14!r}")
        assert abs(share - 5 / 14) <= solver.tolerance / abs(R * side)


def test_alciatores_angles(solver: Solver) -> None:
    """TP A.5, e .94, u_b .06, stun at 30 degrees: the printed angles."""
    angle = np.radians(30)
    params = (R, M, 0.2, 0.2, 0.06, 0.94)
    row = shot(v1=(np.sin(angle), np.cos(angle), 0), params=params)
    got = solver.run(row[None])[0]
    cue = np.degrees(np.arctan2(got[1], got[0]))  # from the tangent line
    ball = np.degrees(np.arctan2(got[6], got[7]))  # from the line of centres
    print(f"{solver.model} {solver.budget:g}: {cue:.4f} {ball:.4f} {90 - cue - ball:.4f}")
    room = 0.0005 + np.degrees(2.3 * solver.tolerance)  # of an angle, at speeds above 0.45
    assert cue == pytest.approx(3.307, abs=room)
    assert ball == pytest.approx(3.434, abs=room)
    assert 90 - cue - ball == pytest.approx(83.259, abs=2 * room)


# -- what every collision keeps --------------------------------------------------------------------


def largest_speed(rows: Array) -> Array:
    radius = rows[:, :1]
    return np.abs(
        np.hstack([rows[:, 9:12], radius * rows[:, 12:15], rows[:, 18:21], radius * rows[:, 21:24]])
    ).max(axis=1)


def without_table(rows: Array) -> Array:
    free = rows.copy()
    free[:, 2:4] = 0.0
    return free


def demand(solver: Solver, what: str, rows: Array, excess: Array, unit: str) -> None:
    """`excess` of each row must not exceed 1."""
    i = int(np.nan_to_num(excess, nan=np.inf).argmax())
    print(f"{what}, {solver.model} {solver.budget:g}: {excess[i]:.3g} of {unit}")
    assert excess[i] <= 1, hexfloats(rows[i])


def test_momentum_is_exact_without_table_friction(solver: Solver, cases: Array) -> None:
    rows = without_table(cases)
    got = solver.run(rows)
    before = rows[:, [9, 10]] + rows[:, [18, 19]]
    after = got[:, [0, 1]] + got[:, [6, 7]]
    room = ROUNDING * np.maximum(largest_speed(rows), 1e-300)
    demand(solver, "momentum", rows, np.abs(after - before).max(axis=1) / room, "rounding")


def test_spins_change_equally(solver: Solver, cases: Array) -> None:
    """Both balls get the same torque about the vertical; without table friction, about all axes."""
    for rows, columns in ((cases, (2,)), (without_table(cases), (0, 1, 2))):
        got = solver.run(rows)
        unequal = [
            rows[:, 0] * ((got[:, 3 + k] - rows[:, 12 + k]) - (got[:, 9 + k] - rows[:, 21 + k]))
            for k in columns
        ]
        room = 4 * ROUNDING * np.maximum(largest_speed(rows), 1e-300)
        excess = np.abs(unequal).max(axis=0) / room
        demand(solver, f"torque about {len(columns)} axes", rows, excess, "rounding")


def transformed(rows: Array, vector: Array, axial: Array) -> Array:
    """Positions, velocities and spins of both balls mapped."""
    out = rows.copy()
    for first in (6, 15):
        for part, matrix in enumerate((vector, vector, axial)):
            at = slice(first + 3 * part, first + 3 * part + 3)
            out[:, at] = rows[:, at] @ matrix.T
    return out


def back(got: Array, vector: Array, axial: Array) -> Array:
    out = got.copy()
    for first, matrix in ((0, vector), (3, axial), (6, vector), (9, axial)):
        out[:, first : first + 3] = got[:, first : first + 3] @ matrix
    return out


def same(solver: Solver, what: str, rows: Array, one: Array, two: Array, room: Array) -> None:
    apart = errors_of(rows, one, two).relative
    assert (one[:, STATUS] == two[:, STATUS]).all()
    equal = (one[:, :12] == two[:, :12]).all(axis=1).mean()
    print(f"{what}: median {np.median(apart):.2g}, equal to the last bit {100 * equal:.0f} %")
    demand(solver, what, rows, apart / room, "two budgets and rounding")


def symmetry_room(solver: Solver, rows: Array) -> Array:
    """Two results within the budget of the same; and rounding, as positions and speeds have it."""
    place = np.abs(rows[:, [6, 7, 15, 16]]).max(axis=1) / rows[:, 0]
    speed = relative_speed(rows)
    return 2 * solver.tolerance + 1e-15 * (10 + place) * largest_speed(rows) / speed


def test_mirror(solver: Solver, cases: Array) -> None:
    vector, axial = np.diag([-1.0, 1.0, 1.0]), np.diag([1.0, -1.0, -1.0])
    got = back(solver.run(transformed(cases, vector, axial)), vector, axial)
    same(solver, "mirror", cases, solver.run(cases), got, symmetry_room(solver, cases))


@pytest.mark.parametrize("degrees", [90, 180, 37.5])
def test_rotation(tool: BenchTool, solver: Solver, cases: Array, degrees: float) -> None:
    """By 37.5 degrees the inputs round, which is allowed what the oracle makes of it."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    if degrees in (90, 180):
        c, s = np.round(c), np.round(s)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    turned = transformed(cases, turn, turn)
    got, room = back(solver.run(turned), turn, turn), symmetry_room(solver, cases)
    if degrees == 37.5:
        exact = back(tool.expect(turned, "exact", solver.model), turn, turn)
        moved = errors_of(cases, exact, tool.expect(cases, "exact", solver.model)).relative
        print(f"rounding of inputs: {moved.max():.2g}, median {np.median(moved):.2g}")
        assert np.median(moved) <= 1e-14 and (moved <= 1e-11).mean() > 0.95
        room += 2 * moved
    same(solver, f"rotation {degrees}", cases, solver.run(cases), got, room)


def test_swap(solver: Solver, cases: Array) -> None:
    order = [0, 1, 3, 2, 4, 5, *range(15, 24), *range(6, 15)]
    got = solver.run(cases[:, order])[:, [*range(6, 12), *range(6), 12]]
    same(solver, "swap", cases, solver.run(cases), got, symmetry_room(solver, cases))


@pytest.mark.parametrize("power", [-40, -1, 3, 60])
def test_homogeneity(solver: Solver, cases: Array, power: int) -> None:
    """Speeds scaled by a power of two scale the result, in kernels to the last bit."""
    scaled = cases.copy()
    scaled[:, [*range(9, 15), *range(18, 24)]] *= 2.0**power
    got = solver.run(scaled)
    got[:, :12] *= 2.0**-power
    base = solver.run(cases)
    same(solver, f"scale 2^{power}", cases, base, got, symmetry_room(solver, cases))
    assert np.array_equal(base, got)


def energy(R: Array, velocities: Array) -> Array:
    """Kinetic energy over M of v1, w1, v2, w2."""
    v = velocities[:, [0, 1, 2, 6, 7, 8]]
    w = velocities[:, [3, 4, 5, 9, 10, 11]] * R[:, None]
    return 0.5 * (v**2).sum(axis=1) + 0.2 * (w**2).sum(axis=1)


def growth(solver: Solver, rows: Array) -> tuple[Array, Array]:
    """What energy grows by, and how exactly that is known."""
    got = solver.run(rows)
    before = np.hstack([rows[:, 9:15], rows[:, 18:24]])
    e_0 = energy(rows[:, 0], before)
    # A result off by E |v| in twelve components, each weighing at most its speed.
    off = solver.tolerance * relative_speed(rows) * 12 * largest_speed(rows) + 1e-14 * e_0
    return energy(rows[:, 0], got) - e_0, off


def test_energy_never_grows(solver: Solver, cases: Array) -> None:
    grown, off = growth(solver, cases)
    speed = relative_speed(cases)
    i = int((grown / speed**2).argmax())
    print(f"{solver.model} {solver.budget:g}: grows by at most {grown[i] / speed[i] ** 2:.2g} v^2")
    if solver.model in BOTTOM:
        demand(solver, "energy", cases, grown / off, "what the budget allows")
    elif solver.budget <= 1e-6:
        assert (grown > 10 * off).any(), "this test sees what the top slip does"


def test_energy_accounts(solver: Solver, cases: Array) -> None:
    """Without table friction and with slip straight up: loss of the normal law and of friction."""
    rows = without_table(cases)[:400]
    V = np.linspace(0.1, 8, len(rows))
    plain = [
        shot(v1=(0, v, 0), w1=(-a * v / p[0], 0, 0), params=p[:6])
        for v, a, p in zip(V, np.linspace(0.001, 2, len(V)), rows, strict=True)
    ]
    rows = np.array(plain)
    u_b, e = rows[:, 4], rows[:, 5]
    c, P = -rows[:, 0] * rows[:, 12], (1 + e) * V / 2
    rate = 6 if solver.lifts else 5
    with np.errstate(divide="ignore"):
        slips = np.minimum(P, c / (rate * u_b))
    loss = (1 - e**2) * V**2 / 4 + u_b * (c * slips - rate * u_b * slips**2 / 2)
    grown, off = growth(solver, rows)
    demand(solver, "energy account", rows, np.abs(grown + loss) / off, "what the budget allows")


def test_the_normal_law(solver: Solver, cases: Array) -> None:
    """Restitution by work: e_b |v_n| without table friction, else within what it can add."""
    for rows in (cases, without_table(cases)):
        got = solver.run(rows)
        d = rows[:, 15:17] - rows[:, 6:8]
        f = d / np.hypot(d[:, 0], d[:, 1])[:, None]
        before = -((rows[:, 18:20] - rows[:, 9:11]) * f).sum(axis=1)
        after = ((got[:, 6:8] - got[:, 0:2]) * f).sum(axis=1)
        q = rows[:, 4] * rows[:, 2:4].max(axis=1)
        spread = np.sqrt((2 + q) / (2 - q))
        off = 3 * solver.tolerance * relative_speed(rows) + 1e-14 * largest_speed(rows)
        off += 1e-15 * np.abs(rows[:, 6:8]).max(axis=1) / rows[:, 0] * largest_speed(rows)
        e = rows[:, 5]
        beyond = np.maximum(after - e * before * spread, e * before / spread - after)
        demand(solver, "normal law", rows, beyond / off, "what the budget allows")
        assert (after >= -off).all()
