"""Exact kernels of the cushion: against exact results, closed forms, and what must hold anyway."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from generator.errors import KernelError
from generator.impacts.ball_cushion.kernels.exact import STEPPERS
from tests.support.cushion import (
    DATA,
    CushionCases,
    CushionFunction,
    cushion_variant,
    errors,
    load_cases,
    load_outcomes,
)
from tests.support.kernels import build_all

CASES = load_cases()
BUDGETS = (1e-3, 1e-6, 1e-9)
VY = 1.3  # m/s
POOL = (0.028575, 0.170097, 0.2, 0.2, 0.85, 1.28 * 0.028575)


@cache
def kernel(
    model: str, budget: float, compiler: str = "gcc", stepper: str = "series"
) -> CushionFunction:
    asked = cushion_variant(
        model=model, budget=budget, stepper=stepper, compiler=compiler, fma="fma"
    )
    library = build_all([asked])[0]
    if isinstance(library, KernelError):
        raise library
    return CushionFunction(library.path)


def wanted(model: str) -> np.ndarray:
    exact = load_outcomes("exact.csv", CASES.ids)
    if model == "clamped":
        return exact
    printed = load_outcomes("exact_printed.csv", CASES.ids)
    return np.where(np.isnan(printed), exact, printed)


def straight(parameters: tuple[float, ...], speed: float, spin: float) -> np.ndarray:
    """Into a cushion along y; `spin`: of rolling, 1 where the ball rolls without slip."""
    return np.array([*parameters, 0, speed, 0, -spin * speed / parameters[0], 0, 0, 0, 1])


def one(row: np.ndarray, model: str = "clamped", budget: float = 1e-9) -> np.ndarray:
    found, status = kernel(model, budget)(row[None])
    assert status[0] == 0
    return found[0]


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("budget", BUDGETS)
@pytest.mark.parametrize("model", ["clamped", "printed"])
@pytest.mark.parametrize("stepper", STEPPERS)
def test_errors_keep_to_the_budget(stepper: str, model: str, budget: float, compiler: str) -> None:
    found, status = kernel(model, budget, compiler, stepper)(CASES.rows)
    off = errors(found, wanted(model), CASES) / budget
    worst = int(np.argmax(off))
    print(
        stepper, model, f"{budget:g}: {off[worst]:.3g} of it,", CASES.kinds[worst], CASES.ids[worst]
    )
    assert (status == 0).all()
    assert off.max() <= 1


@pytest.mark.parametrize("budget", BUDGETS)
def test_slips_that_come_back_or_barely_pass_zero_keep_to_the_budget(budget: float) -> None:
    """Cases that series once missed by up to a thousand budgets, and the oracle's answers."""
    table = np.loadtxt(DATA / "series_cases.csv", delimiter=",", skiprows=1, usecols=range(1, 21))
    rows = np.ascontiguousarray(table[:, :14])
    cases = CushionCases(("",) * len(rows), ("series",) * len(rows), rows)
    found, status = kernel("clamped", budget)(rows)
    off = errors(found, table[:, 14:], cases) / budget
    print(f"{budget:g}: {off.max():.3g} of it")
    assert (status == 0).all()
    assert off.max() <= 1


def test_a_straight_roll_that_sticks_has_its_closed_form() -> None:
    for speed in (1e-6, 1e-3, 1.0, 50.0):
        ratio = -one(straight(POOL, speed, 1))[1] / speed
        print(speed, ratio - 0.8042818992213045)
        assert ratio == pytest.approx(0.8042818992213045, abs=1e-9)


def test_a_straight_roll_of_the_paper_has_its_closed_form() -> None:
    paper = (0.02625, 0.1406, 0.212, 0.14, 0.98, 1.4 * 0.02625)
    assert -one(straight(paper, 1.0, 1))[1] == pytest.approx(0.9106577416984531, abs=1e-9)


def test_a_nose_that_sticks_all_through_has_its_closed_form() -> None:
    start = straight((1 / 32, 0.2, 0.2, 0.5, 0.85, 1.5 / 32), 1.0, -0.5)  # c_z = 0
    assert -one(start)[1] == pytest.approx(0.6721743617775072, abs=1e-9)


def test_without_friction_the_speed_into_the_cushion_turns_round_and_all_else_stays() -> None:
    row = np.array([0.03, 0.2, 0, 0, 0.7, 0.04, 1.0, 2.0, 0, 30.0, -20.0, 10.0, 0, 1])
    assert one(row) == pytest.approx([1.0, -1.4, 0, 30.0, -20.0, 10.0], abs=1e-14)


@pytest.mark.parametrize("budget", BUDGETS)
@pytest.mark.parametrize("friction", [5e-324, 1e-200, 1e-155, 1e-101, 1e-99, 1e-30])
def test_next_to_no_friction_is_as_good_as_none(friction: float, budget: float) -> None:
    for place in (2, 3):  # of u_s, which only a roll meets, and of u_w
        little, none = list(POOL), list(POOL)
        little[place], none[place] = friction, 0.0
        for spin in (0.0, 1.0):
            found = one(straight(tuple(little), VY, spin), budget=budget)
            off = np.abs(found - one(straight(tuple(none), VY, spin), budget=budget))
            print(f"{friction:.0e}: {off[:3].max() / VY:.1e} of the speed")
            assert off[:3].max() <= 2 * budget * VY


def test_a_level_nose_and_no_draw_have_a_closed_form() -> None:
    """h = R, w_x = 0: friction along x alone, until the slip ends."""
    radius, u_w, e = 0.03, 0.2, 0.8
    for v_x in (0.2, 3.0):
        row = np.array([radius, 0.2, 0.3, u_w, e, radius, v_x, VY, 0, 0, 0, 0, 0, 1])
        change = -min(u_w * (1 + e) * VY, 2 / 7 * v_x)
        assert one(row)[:2] == pytest.approx([v_x + change, -e * VY], abs=2e-9)


@pytest.mark.parametrize("model", ["clamped", "printed"])
def test_mirrored_and_turned_impacts_end_mirrored_and_turned(model: str) -> None:
    rows = CASES.rows[:100]
    found, _ = kernel(model, 1e-6)(rows)
    mirrored = rows * [*[1] * 6, -1, 1, 1, 1, -1, -1, -1, 1]  # x to -x; spins turn over but w_x
    other, _ = kernel(model, 1e-6)(mirrored)
    assert np.abs(other - found * [-1, 1, 1, 1, -1, -1]).max() < 1e-12
    turned = rows.copy()
    for at in (6, 9, 12):
        turned[:, at], turned[:, at + 1] = -rows[:, at + 1], rows[:, at]
    other, _ = kernel(model, 1e-6)(turned)
    back = found.copy()
    for at in (0, 3):
        back[:, at], back[:, at + 1] = -found[:, at + 1], found[:, at]
    assert np.abs(other - back).max() < 1e-12


def test_all_speeds_scale_together_and_mass_counts_for_nothing() -> None:
    found, _ = kernel("clamped", 1e-6)(CASES.rows)
    for factor in (2.0**-600, 2.0**-20, 2.0**40):
        scaled = CASES.rows.copy()
        scaled[:, 6:12] *= factor
        scaled[:, 1] *= 3
        other, status = kernel("clamped", 1e-6)(scaled)
        assert (status == 0).all()
        assert np.array_equal(other / factor, found)


def test_kinetic_energy_never_grows() -> None:
    for budget in BUDGETS:
        found, _ = kernel("clamped", budget)(CASES.rows)
        inertia = 0.4 * CASES.radii**2
        energy = [
            (v[:, :2] ** 2).sum(axis=1) + inertia * (v[:, 3:] ** 2).sum(axis=1)
            for v in (CASES.before, found)
        ]
        growth = (energy[1] / energy[0] - 1).max()
        print(f"{budget:g}: largest relative growth {growth:.2g}")
        assert growth <= budget


def test_an_invariant_of_the_equations_stays() -> None:
    """R w_y + 5/2 v_x + (1 + S)/C R w_z, on the cushion's axes."""
    found, _ = kernel("clamped", 1e-3)(CASES.rows)
    radius, height, n_x, n_y = (CASES.rows[:, i] for i in (0, 5, 12, 13))
    sine = height / radius - 1
    parts = []
    for v in (CASES.before, found):
        v_x = v[:, 0] * n_y - v[:, 1] * n_x
        w_y = v[:, 3] * n_x + v[:, 4] * n_y
        parts.append(
            radius * w_y + 2.5 * v_x + (1 + sine) / np.sqrt(1 - sine**2) * radius * v[:, 5]
        )
    speed = np.abs(CASES.before) @ [1, 1, 1, 0.03, 0.03, 0.03]
    assert (np.abs(parts[1] - parts[0]) / speed).max() < 1e-14


def test_what_cannot_collide_keeps_its_velocities_and_says_so() -> None:
    row = straight(POOL, 1.0, 1)
    cases = {
        "leaves": (1, {7: -1.0}),
        "passes": (1, {6: 1.0, 7: 0.0}),
        "not a number": (2, {9: math.nan}),
        "infinite": (2, {6: math.inf}),
        "no normal": (2, {12: 0.0, 13: 0.0}),
        "nose below the centre": (2, {5: 0.9 * POOL[0]}),
        "nose on top": (2, {5: 2 * POOL[0]}),
        "no height": (2, {5: 0.0}),
        "jams": (2, {2: 0.6, 3: 0.9, 5: 1.7 * POOL[0]}),
        "no radius": (2, {0: 0.0}),
        "friction below 0": (2, {3: -0.1}),
        "too fast": (2, {7: 1e101}),
    }
    for name, (code, changes) in cases.items():
        given = row.copy()
        for at, value in changes.items():
            given[at] = value
        found, status = kernel("clamped", 1e-6)(given[None])
        print(name, status)
        assert status[0] == code, name
        assert np.array_equal(found[0], given[6:12], equal_nan=True), name


def test_extreme_impacts_end() -> None:
    rng = np.random.default_rng(17)
    rows = CASES.rows.copy()
    rows[:, 6:12] *= 10.0 ** rng.uniform(-12, 12, (len(rows), 6))
    slow = rows[:, 6] * rows[:, 12] + rows[:, 7] * rows[:, 13] > 0
    for model in ("clamped", "printed"):
        found, status = kernel(model, 1e-6)(rows)
        assert np.isfinite(found).all()
        assert (status == np.where(slow, 0, 1)).all()


def test_a_batch_gives_what_calls_give() -> None:
    rows = CASES.rows.copy()
    rows[:, :6] = POOL
    called, status = kernel("clamped", 1e-6)(rows)
    batch, statuses, good = kernel("clamped", 1e-6).batch(rows[0, :6], rows[:, 6:])
    assert np.array_equal(batch, called)
    assert np.array_equal(status, statuses)
    assert good == (status == 0).sum()
    each = np.linspace(0, 0.4, len(rows))
    rows[:, 3] = each
    called, status = kernel("clamped", 1e-6)(rows)
    batch, statuses, _ = kernel("clamped", 1e-6).batch(rows[0, :6], rows[:, 6:], each)
    assert np.array_equal(batch, called)
    assert np.array_equal(status, statuses)
