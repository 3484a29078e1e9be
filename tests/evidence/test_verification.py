"""Verdicts: the oracle in double passes, and planted faults do not."""

from __future__ import annotations

import numpy as np
import pytest

from generator.errors import InputError, KernelError
from generator.evidence.verification.errors import Array
from generator.evidence.verification.reference import Reference
from generator.impacts.ball_ball.evidence import MODELS, PUBLISHED
from generator.impacts.ball_ball.evidence.fixed_steps import (
    chatter_margin,
    euler_verdict,
    flip_limit,
)
from generator.impacts.ball_ball.evidence.measure import STICKS, approach_speed, errors_of
from tests.support.reference import FOLDER, exact_verdict, load_reference


@pytest.fixture(scope="module")
def reference() -> Reference:
    return load_reference()


@pytest.fixture(scope="module")
def scheme(reference: Reference) -> Array:
    """pooltool's own results as if they were the scheme in long double."""
    return np.hstack([reference.published[PUBLISHED], np.zeros((len(reference.ids), 1))])


def spoiled(rows: Array, where: list[int], column: int, change: float) -> Array:
    copy = rows.copy()
    copy[where, column] += change
    return copy


def sliding(reference: Reference) -> list[int]:
    return [int(i) for i in np.flatnonzero(reference.exact["pooltool"][:, STICKS] == 0)]


def euler_of(reference: Reference, scheme: Array, got: Array):
    return euler_verdict(reference.cases, got, scheme, reference.exact["pooltool"], 1000)


def test_reference_is_complete(reference: Reference) -> None:
    sticks = {model: int(reference.exact[model][:, STICKS].sum()) for model in MODELS}
    print(f"{len(reference.ids)} cases, {len(set(reference.kinds))} kinds, sticking {sticks}")
    assert reference.cases.shape == (950, 24)
    assert all(reference.exact[model].shape == (950, 14) for model in MODELS)
    assert reference.published[PUBLISHED].shape == (950, 13)
    assert len(reference.rows_of("seed_case")) == 5
    assert (approach_speed(reference.cases) > 0).all()


def test_reference_with_a_missing_column_is_named(reference: Reference, tmp_path) -> None:
    text = (FOLDER / "inputs.csv").read_text("utf-8")
    (tmp_path / "inputs.csv").write_text(text.replace("u_b", "mu"), encoding="utf-8")
    for name in ("exact_mathavan2014", "exact_bottom_slip", "exact_pooltool", "euler_n1000"):
        (tmp_path / f"{name}.csv").write_bytes((FOLDER / f"{name}.csv").read_bytes())
    with pytest.raises(InputError, match=r"inputs\.csv: row 1: no column u_b"):
        load_reference(tmp_path)


def test_errors_measure_spin_by_the_radius() -> None:
    case = np.zeros((1, 24))
    case[0, [0, 1, 9]] = 0.03, 0.2, 2.0  # R, M, v1x
    want = np.zeros((1, 13))
    got = want.copy()
    got[0, [0, 3]] = 0.001, 0.1
    errors = errors_of(case, got, want)
    assert errors.absolute[0] == pytest.approx(0.003)
    assert errors.relative[0] == pytest.approx(0.0015)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_nan_is_an_error_unless_expected(value: float) -> None:
    case, want = np.ones((1, 24)), np.ones((1, 13))
    got = want.copy()
    got[0, 4] = value
    assert errors_of(case, got, want).absolute[0] == np.inf
    assert errors_of(case, want, got).absolute[0] == np.inf
    assert errors_of(case, got, got).absolute[0] == 0


def test_euler_verdict_passes_the_scheme(reference: Reference, scheme: Array) -> None:
    got = spoiled(scheme, sliding(reference), 0, 9e-7)
    verdict = euler_of(reference, scheme, got)
    print(verdict)
    assert verdict.passed
    assert verdict.flips == ()
    assert verdict.max_abs_error == pytest.approx(9e-7)
    assert verdict.sticking == 147
    assert verdict.cases == 950


def even_cases(e_b: float, count: int = 1000) -> Array:
    """Shots without spin: every step adds the same to v_n."""
    rows = np.zeros((count, 24))
    rows[:, :6] = (0.03, 0.2, 0.2, 0.2, 0.05, e_b)
    rows[:, 16] = 0.06  # ball 2 lies along y
    rows[:, 9:11] = 0.2, 1.0
    return rows


@pytest.mark.parametrize(
    ("e_b", "spin", "passes"),
    [(0.0, 0.0, True), (1.0, 0.0, True), (0.6, 0.0, True), (0.7, 0.0, False), (1.0, 1e-9, False)],
)
def test_flips_of_exact_ties_are_no_share_of_the_kernel(e_b: float, spin: float, passes: bool):
    """1000 / (1 + e_b) steps of compression are whole for e_b = 0, 0.6, 1; spin presses a ball."""
    cases = even_cases(e_b)
    cases[:, 12] = spin
    expected = np.zeros((len(cases), 14))
    got = expected[:, :13].copy()
    got[:20, 1] = 0.9e-3  # nearly a step: 2 %
    verdict = euler_verdict(cases, got, expected, expected, 1000)
    print(verdict.reason)
    assert verdict.passed is passes
    assert len(verdict.flips) == 20
    got[0, 1] = 1.1e-3
    assert not euler_verdict(cases, got, expected, expected, 1000).passed


def test_euler_verdict_lists_flips_up_to_half_a_percent(
    reference: Reference, scheme: Array
) -> None:
    slips = sliding(reference)
    step = 0.9 * flip_limit(reference.cases, 1000)
    slips = [i for i in slips if step[i] > 2e-6]
    few, many = slips[:4], slips[:6]  # 0.42 % and 0.63 % of 950
    for flips, passes in ((few, True), (many, False)):
        got = scheme.copy()
        got[flips, 7] += step[flips]
        verdict = euler_of(reference, scheme, got)
        print(f"{len(flips)} flips: {verdict.reason}")
        assert verdict.passed is passes
        assert verdict.flips == tuple(flips)


def test_euler_verdict_fails_more_than_a_step(reference: Reference, scheme: Array) -> None:
    i = sliding(reference)[7]
    got = spoiled(scheme, [i], 6, 1.1 * flip_limit(reference.cases, 1000)[i])
    verdict = euler_of(reference, scheme, got)
    print(verdict.reason)
    assert not verdict.passed
    assert verdict.worst_case == i


@pytest.mark.parametrize("sticks", [False, True])
def test_euler_verdict_fails_nan(reference: Reference, scheme: Array, sticks: bool) -> None:
    rows = np.flatnonzero(reference.exact["pooltool"][:, STICKS] == sticks)
    got = spoiled(scheme, [int(rows[3])], 8, np.nan)
    verdict = euler_of(reference, scheme, got)
    print(verdict.reason)
    assert not verdict.passed
    assert verdict.worst_case == rows[3]


def test_euler_verdict_holds_sticking_cases_to_the_exact_result(
    reference: Reference, scheme: Array
) -> None:
    exact = reference.exact["pooltool"]
    i = int(np.flatnonzero(exact[:, STICKS])[5])
    own = errors_of(reference.cases, scheme, exact).absolute[i]
    margin = chatter_margin(reference.cases, 1000)[i]
    print(f"scheme {own:.3g} m/s from exact, margin {margin:.3g} m/s")
    assert euler_of(reference, scheme, spoiled(scheme, [i], 0, 0.5 * margin)).passed
    assert not euler_of(reference, scheme, spoiled(scheme, [i], 0, 2.1 * own + 1.1 * margin)).passed


def test_a_wrong_status_fails_both_verdicts(reference: Reference, scheme: Array) -> None:
    got = spoiled(scheme, [11], 12, 2)
    verdict = euler_of(reference, scheme, got)
    assert not verdict.passed
    assert "case 11: status 2, not 0" in verdict.reason
    exact = reference.exact["pooltool"]
    assert not exact_verdict(reference.cases, spoiled(exact, [11], 12, np.nan), exact, 1).passed


def test_velocities_must_stay_without_an_outcome(reference: Reference) -> None:
    exact = reference.exact["pooltool"].copy()
    exact[5, 12] = 1
    verdict = exact_verdict(reference.cases, spoiled(exact, [5], 2, 1e-15), exact, 1e-3)
    print(verdict.reason)
    assert not verdict.passed


def test_exact_verdict_holds_the_budget(reference: Reference) -> None:
    exact = reference.exact["mathavan2014"]
    speed = np.linalg.norm(reference.cases[:, 9:12] - reference.cases[:, 18:21], axis=1)
    got = exact.copy()
    got[:, 6] += 0.9e-6 * speed
    inside = exact_verdict(reference.cases, got, exact, 1e-6)
    print(inside)
    assert inside.passed
    assert inside.max_rel_error == pytest.approx(0.9e-6, rel=1e-6)
    got[17, 6] += 0.2e-6 * speed[17]
    outside = exact_verdict(reference.cases, got, exact, 1e-6)
    assert not outside.passed
    assert outside.worst_case == 17
    got[17, 6] = np.nan
    assert not exact_verdict(reference.cases, got, exact, 1e-6).passed


def test_no_cases_and_wrong_shapes_are_no_pass(reference: Reference) -> None:
    none = np.empty((0, 24))
    assert not exact_verdict(none, np.empty((0, 13)), np.empty((0, 14)), 1e-3).passed
    with pytest.raises(KernelError, match="got"):
        exact_verdict(reference.cases, np.zeros((949, 13)), reference.exact["pooltool"], 1e-3)
