"""Steps are as long as docs/step-control.md says: inputs that a search found once, thresholds."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest

from generator.evidence.timing.bench_tool import ROOT
from generator.evidence.verification.errors import Array
from generator.impacts.ball_ball.evidence.measure import CASE_NAMES, errors_of
from generator.impacts.ball_ball.steppers.exact.ellipse import steepness, sticking_bound
from generator.registry.lane_numbers import float_lanes
from generator.tableaus.tableaus import TABLEAUS
from tests.support.exact_kernels import built, exact_variant, portable_target
from tests.support.kernels import bench_tool
from tests.support.reference import load_hard

ADVERSARIAL = ROOT / "tests" / "data" / "adversarial"
SMOOTH = ("mathavan2014", "bottom_slip")


def adversarial(model: str) -> dict[float, Array]:
    """The kept inputs by the budget that they were found for, without those of the corner."""
    with (ADVERSARIAL / "list.csv").open(encoding="utf-8") as file:
        listed = {(r["model"], r["id"]): r for r in csv.DictReader(file)}
    found: dict[float, list[list[float]]] = {}
    with (ADVERSARIAL / f"inputs_{model}.csv").open(encoding="utf-8") as file:
        for record in csv.DictReader(file):
            known = listed[model, record["id"]]
            if known["where"] != "corner":
                row = [float(record[name]) for name in CASE_NAMES]
                found.setdefault(float(known["budget"]), []).append(row)
    return {budget: np.array(rows) for budget, rows in found.items()}


def over_budget(model: str, budget: float, cases: Array) -> float:
    """The largest error over the budget, by call and, where there are any, by lanes of floats."""
    single = exact_variant(model, budget)
    widths = float_lanes(single, portable_target())[:1]
    options = {"lane_root": single["root"], "interleave": "s2", "numbers": "float"}
    libraries = built([single, *(single.in_lanes(w, **options) for w in widths)])
    exact = bench_tool().expect(cases, "exact", model)
    worst = 0.0
    for i, library in enumerate(libraries):
        got = bench_tool().run_kernel(library, cases, batch=i > 0)
        assert (got[:, 12] == exact[:, 12]).all()
        worst = max(worst, float(errors_of(cases, got, exact).relative.max()) / budget)
    return worst


@pytest.mark.parametrize("model", ("mathavan2014", "bottom_slip", "pooltool"))
def test_inputs_that_a_search_found_are_within_budget(model: str) -> None:
    for budget, cases in adversarial(model).items():
        worst = over_budget(model, budget, cases)
        print(f"{model} {budget:g}: {len(cases)} inputs, at most {worst:.3g} of the budget")
        assert worst < 1


@pytest.mark.parametrize("model", SMOOTH)
def test_error_of_q_into_sticking_is_seen_where_slip_points_along_its_rate(model: str) -> None:
    """Neighbours of the kept inputs at u_s near 1, which were off by up to 1.57 E."""
    kinds, rows = load_hard()
    kept = rows[[kind == "sticks_along_rate" for kind in kinds]]
    cases = np.repeat(kept, 500, axis=0)
    rng = np.random.default_rng(15)
    moves = [CASE_NAMES.index(name) for name in ("u_b", "v1x", "w1x", "w1z", "w2x", "w2y")]
    size = 10 ** rng.uniform(-5, -1, (len(cases), 1))
    cases[:, moves] *= 1 + size * rng.normal(size=(len(cases), len(moves)))
    cases[:, 2:4] = 1 - 0.1 * size
    worst, of_kept = over_budget(model, 1e-6, cases), over_budget(model, 1e-6, kept)
    print(f"{model}: kept {of_kept:.3g}, {len(cases)} neighbours {worst:.3g} of 1e-6 at most")
    assert max(worst, of_kept) < 1


@pytest.mark.parametrize("model", SMOOTH)
def test_small_restitution_has_no_threshold(model: str) -> None:
    (case,) = adversarial("mathavan2014")[1e-6][1:2]
    cases = np.tile(case, (40, 1))
    cases[:, 5] = [0.0, *np.geomspace(1e-12, 0.3, 39)]
    worst = over_budget(model, 1e-6, cases)
    print(f"{model}: e_b from 0 to 0.3, at most {worst:.3g} of 1e-6")
    assert worst < 1


@pytest.mark.parametrize("name", ("ss43", "dp54", "dop853"))
def test_bound_of_the_step_into_sticking_holds_off_its_own_grid(name: str) -> None:
    tableau = TABLEAUS[name]
    factor, power = sticking_bound(tableau)
    rng = np.random.default_rng(5)
    most = 0.0
    for _ in range(500):
        at, miss = rng.uniform(-2, 3), 10 ** rng.uniform(-2, 0.5)
        total = math.hypot(at, miss) + math.hypot(1 - at, miss)
        rho = total + math.sqrt(total * total - 1)
        whole = math.hypot(1 - at, miss) - math.hypot(at, miss)
        seen = 0.0
        for weight, share in zip(tableau.b, map(float, tableau.c), strict=False):
            x = 1 - (1 - share) ** 2 - at
            seen += float(weight) * 2 * (1 - share) * x / math.hypot(x, miss)
        most = max(most, abs(seen - whole) / (factor * steepness(rho) ** power))
    print(f"{name}: at most {most:.2f} of {factor:.3g} / P^{power}")
    assert most < 1
