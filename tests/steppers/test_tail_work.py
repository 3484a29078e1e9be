"""What the work of a step into sticking is off by shows in one of its two embedded errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from generator.tableaus.tableau import Row, Tableau
from generator.tableaus.tableaus import TABLEAUS

Array = NDArray[np.float64]
K_X, K_XT, K_Z, K_ZT = 7.0, 1.0, 5.0, 2.5  # of equal balls, as docs/step-control.md has them
BEND = 2 * (K_X / K_Z - 1)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)
ROOT = (NODES + 1) / 2  # cube root of what is left of t
OF_ACCOUNT = 0.1  # share of the largest error with the same friction; below it, |c_x| is small
FRICTIONS = (0, 0.05, 0.1, 0.2, 0.373, 0.5, 0.7, 1)


@dataclass(frozen=True)
class Work:
    """Of slips whose direction on the table stays, in units of u_s |c_z| |c|/u_b."""

    missed: Array
    of_q: Array  # embedded error of q, times twice the friction
    of_work: Array  # that of the work


def _summed(weights: Row, values: list[Array]) -> Array:
    """Zero where there are no values."""
    total = np.zeros_like(values[0]) if values else np.zeros(1)
    for weight, value in zip(weights, values, strict=False):
        total = total + float(weight) * value
    return total


def work_errors(tableau: Tableau, ratio: Array, u_s: float, angle: Array) -> Work:
    """Contact slips are c_x = ratio c_z. The work is the integral of 2 left q, left = 1 - t."""
    u_x, u_y = np.cos(angle), np.sin(angle)
    k = K_Z - K_ZT * u_s * u_y
    q_rates: list[Array] = []
    r_rates: list[Array] = []
    work: list[Array] = []
    for row, at in zip(tableau.a, tableau.c, strict=False):
        left = 1 - float(at)
        q, r = _summed(row, q_rates), ratio + _summed(row, r_rates)
        work.append(2 * left * q)
        q_rates.append(np.hypot(1, r * left**BEND) * 2 * left / k)
        turned = K_X * K_ZT / K_Z * u_y * r + (K_XT * u_x / left**BEND if left else 0 * u_x)
        r_rates.append(-2 * u_s * turned / (left * k) if left else 0 * r)

    left = ROOT**3
    settled = (-2 * u_s * u_x * K_XT / k / (BEND + 2 * u_s * u_y * K_X * K_ZT / K_Z / k))[..., None]
    power = (2 * (K_X / k - 1))[..., None]
    slips = (ratio[..., None] - settled) * left**power + settled
    whole = np.hypot(1, slips) * 2 * left**3 / k[..., None] * 3 * ROOT**2 @ WEIGHTS / 2
    size = np.hypot(1, ratio)
    return Work(
        np.abs(_summed(tableau.b, work) - whole) / size,
        np.abs(_summed(tableau.error, q_rates)) / size,
        np.abs(_summed(tableau.error, work)) / size,
    )


def sampled(tableau: Tableau, u_s: float) -> Work:
    rng = np.random.default_rng(8)
    ratio = rng.choice((-1, 1), 8000) * 10 ** rng.uniform(-2, 2, 8000)
    return work_errors(tableau, ratio, u_s, rng.uniform(-np.pi, np.pi, 8000))


@pytest.mark.parametrize("name", ("ss43", "dp54"))
def test_error_of_the_work_into_sticking_shows_in_one_of_two_estimates(name: str) -> None:
    tableau = TABLEAUS[name]
    for u_s in FRICTIONS:
        work = sampled(tableau, u_s)
        share = work.missed / (work.of_q + work.of_work)
        most = share[work.missed > OF_ACCOUNT * work.missed.max()].max()
        print(f"{name}, u_s {u_s}: at most {most:.2f} of {tableau.work_share}")
        assert most < tableau.work_share


def test_embedded_error_of_the_impulse_alone_does_not_show_it() -> None:
    """So an ordinary collision was off by 1.76 budgets: q was, by a hundred times its estimate."""
    work = sampled(TABLEAUS["dp54"], 0.373)
    counts = work.missed > OF_ACCOUNT * work.missed.max()
    most = (work.missed / work.of_q)[counts].max()
    print(f"error of the work over that of q alone: up to {most:.0f}")
    assert most > 10


def test_order_8_shows_it_but_where_both_estimates_vanish() -> None:
    tableau = TABLEAUS["dop853"]
    for u_s in FRICTIONS:
        work = sampled(tableau, u_s)
        hidden = work.missed > tableau.work_share * (work.of_q + work.of_work)
        hidden &= work.missed > OF_ACCOUNT * work.missed.max()
        print(f"dop853, u_s {u_s}: {hidden.mean():.1e} of directions and ratios are hidden")
        assert hidden.mean() < 2e-3
