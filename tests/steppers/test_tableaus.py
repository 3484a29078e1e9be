"""Runge-Kutta tableaus: order conditions by rooted trees in exact rationals, and convergence."""

from __future__ import annotations

import importlib
import math
import pkgutil
import re
from collections.abc import Iterator
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

import generator.tableaus as tableau_room
from generator.emission.kernel_source import emit
from generator.evidence.timing.bench_tool import ROOT
from generator.impacts.ball_ball.models import find_model
from generator.impacts.ball_ball.steppers.exact.step import ExactLowering
from generator.impacts.ball_ball.steppers.exact.writing import Equations, Writing
from generator.registry.names import name_of, variant_of
from generator.registry.rules import broken_rule
from generator.registry.variant import Stepper, Variant, make_variant
from generator.steppers.budgets import plan_for
from generator.tableaus.tableau import Row, Tableau
from generator.tableaus.tableaus import TABLEAUS
from tests.support.exact_kernels import built, portable_target
from tests.support.kernels import bench_tool
from tests.support.reference import exact_verdict, load_reference

FAMILY = tuple(TABLEAUS.values())
NAMES = tuple(TABLEAUS)
Tree = tuple["Tree", ...]  # a root with its subtrees

each_tableau = pytest.mark.parametrize("tableau", FAMILY, ids=NAMES)


# -- rooted trees ----------------------------------------------------------------------------------


@cache
def trees(nodes: int) -> tuple[Tree, ...]:
    """All rooted trees with so many nodes."""

    def forests(left: int, largest: int, last: int) -> Iterator[Tree]:
        if left == 0:
            yield ()
        for size in range(min(left, largest), 0, -1):
            found = trees(size)
            start = last if size == largest else len(found) - 1
            for i in range(start, -1, -1):
                for rest in forests(left - size, size, i):
                    yield (found[i], *rest)

    if nodes == 1:
        return ((),)
    return tuple(forests(nodes - 1, nodes - 1, len(trees(nodes - 1)) - 1))


def nodes_of(tree: Tree) -> int:
    return 1 + sum(nodes_of(branch) for branch in tree)


def density(tree: Tree) -> int:
    return nodes_of(tree) * math.prod(density(branch) for branch in tree)


def elementary_weights(tree: Tree, a: tuple[Row, ...]) -> list[Fraction]:
    """What each stage makes of a tree."""
    product = [Fraction(1)] * len(a)
    for branch in tree:
        inner = elementary_weights(branch, a)
        for i, row in enumerate(a):
            product[i] *= sum((w * v for w, v in zip(row, inner[:i], strict=True) if w), Fraction())
    return product


def residual(weights: Row, a: tuple[Row, ...], nodes: int) -> Fraction:
    """How far weights are from the conditions of one order, at most."""
    found = []
    for tree in trees(nodes):
        value = sum(w * v for w, v in zip(weights, elementary_weights(tree, a), strict=True) if w)
        found.append(abs(value - Fraction(1, density(tree))))
    return max(found)


def padded(tableau: Tableau) -> tuple[Row, ...]:
    """`a` with as many weights in row i as there are stages before it."""
    return tuple((*row, *[Fraction()] * (i - len(row))) for i, row in enumerate(tableau.a))


def nodes_of_stages(tableau: Tableau) -> Row:
    """Where in a step its stages are."""
    return tuple(sum(row, Fraction()) for row in tableau.a)


def test_as_many_trees_as_there_are() -> None:
    assert [len(trees(n)) for n in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]
    assert all(nodes_of(tree) == 7 for tree in trees(7)) and len(set(trees(7))) == 48


# -- what a tableau must be ------------------------------------------------------------------------


@each_tableau
def test_shape(tableau: Tableau) -> None:
    """First same as last: the last row is b; its stage is the end of the step."""
    assert all(len(row) <= i for i, row in enumerate(tableau.a))
    c = nodes_of_stages(tableau)
    assert len(tableau.embedded) == len(tableau.b) == tableau.stages
    assert c[0] == 0 and c[-1] == 1, "the last stage is not at the end"
    assert tableau.b[:-1] == tableau.a[-1] and tableau.b[-1] == 0
    assert tableau.order > tableau.embedded_order
    assert tableau.source
    rows = [row for row in tableau.a[1:] if any(row)]
    assert len(rows) == tableau.stages - 1, "a stage at the start of the step repeats the first"


@each_tableau
def test_order_conditions(tableau: Tableau) -> None:
    """Up to the order all conditions hold; at the next one some do not, or it would be higher."""
    a = padded(tableau)
    for weights, order in (
        (tableau.b, tableau.order),
        (tableau.embedded, tableau.embedded_order),
    ):
        for nodes in range(1, order + 1):
            off = residual(weights, a, nodes)
            assert off <= tableau.rounding, f"order {nodes}: off by {float(off):.2g}"
        if order < 8:
            assert residual(weights, a, order + 1) > 1e-8


@each_tableau
def test_work_is_as_exact_as_the_step(tableau: Tableau) -> None:
    """b (1 - c) integrates twice: of q^k, 1 / ((k + 1)(k + 2)) remains."""
    pairs = list(zip(tableau.b, nodes_of_stages(tableau), strict=True))
    for k in range(tableau.order - 1):
        twice = sum(w * (1 - c) * c**k for w, c in pairs)
        assert abs(twice - Fraction(1, (k + 1) * (k + 2))) <= tableau.rounding


# -- convergence -----------------------------------------------------------------------------------

Array = NDArray[np.longdouble]


ECCENTRICITY = np.longdouble(0.3)


def kepler(y: Array) -> Array:
    """Rates of an orbit of period 2 pi: a smooth problem with a known solution."""
    return np.concatenate([y[2:], -y[:2] / np.sqrt(y[0] ** 2 + y[1] ** 2) ** 3])


def orbit(t: float | np.longdouble) -> Array:
    """The solution, from Kepler's equation by Newton's method."""
    e, x = ECCENTRICITY, np.longdouble(t)
    for _ in range(20):
        x -= (x - e * np.sin(x) - t) / (1 - e * np.cos(x))
    root, distance = np.sqrt(1 - e * e), 1 - e * np.cos(x)
    place = (np.cos(x) - e, root * np.sin(x))
    return np.array([*place, -np.sin(x) / distance, root * np.cos(x) / distance])


def as_long_double(weight: Fraction) -> np.longdouble:
    return np.longdouble(weight.numerator) / np.longdouble(weight.denominator)


def stages_of(tableau: Tableau, y: Array, h: float, first: Array) -> tuple[Array, list[Array]]:
    """End of a step and the rates at its stages; the last of them is at the end."""
    k = [first]
    for row in tableau.a[1:]:
        at = y + h * sum(as_long_double(w) * r for w, r in zip(row, k, strict=False) if w)
        k.append(kepler(at))
    return at, k


def error_along_an_orbit(tableau: Tableau, steps: int) -> float:
    """The mean over the steps of three quarters of an orbit."""
    y, h, errors = orbit(0.0), np.longdouble(4.5) / steps, []
    rate = kepler(y)
    for i in range(steps):
        y, k = stages_of(tableau, y, h, rate)
        rate = k[-1]
        errors.append(np.linalg.norm((y - orbit((i + 1) * h)).astype(float)))
    return float(np.mean(errors))


@each_tableau
def test_converges_with_its_order(tableau: Tableau) -> None:
    steps = (50, 100, 200, 400)
    errors = [error_along_an_orbit(tableau, n) for n in steps]
    slopes = -np.diff(np.log2(errors))
    shown = ", ".join(f"{slope:.2f}" for slope in slopes)
    print(f"{tableau.name}: slopes {shown}; errors {errors[0]:.2g} to {errors[-1]:.2g}")
    # The highest orders end in rounding; errors of small constants start with higher terms.
    assert tableau.order - 0.3 <= slopes.max() and slopes.mean() <= tableau.order + 1


@each_tableau
def test_error_estimate_shrinks_with_the_embedded_order(tableau: Tableau) -> None:
    y = orbit(0.0)
    sizes = []
    for h in (0.1, 0.05):
        _, k = stages_of(tableau, y, h, kepler(y))
        terms = (as_long_double(w) * r for w, r in zip(tableau.error, k, strict=True) if w)
        sizes.append(float(np.abs(h * sum(terms)).max()))
    slope = math.log2(sizes[0] / sizes[1])
    print(f"{tableau.name}: slope of the estimate {slope:.2f}")
    assert tableau.embedded_order + 0.5 <= slope <= tableau.embedded_order + 2


# -- kernels ---------------------------------------------------------------------------------------


def variant_of_tableau(tableau: Tableau, budget: float, compiler: str) -> Variant:
    target = portable_target()
    stepper = Stepper(tableau.name, budget=budget)
    fma = "fma" if target.has("fma") else "nofma"
    options = {"root": "inv", "fma": fma, "compiler": compiler}
    made = make_variant(target.name, "any", "mathavan2014", stepper, 1, **options)
    assert broken_rule(made, target) is None
    return made


def test_every_tableau_joins_the_list() -> None:
    """Each that a module of generator/tableaus makes is one that can be asked for by name."""
    rooms = pkgutil.iter_modules(tableau_room.__path__, f"{tableau_room.__name__}.")
    values = [v for room in rooms for v in vars(importlib.import_module(room.name)).values()]
    values += [each for value in values if isinstance(value, tuple) for each in value]
    made = {id(value): value for value in values if isinstance(value, Tableau)}.values()
    strangers = [tableau.name for tableau in made if TABLEAUS.get(tableau.name) is not tableau]
    print(f"{len(made)} tableaus are made, {len(TABLEAUS)} have a name")
    assert not strangers, f"{strangers}: join LOW_ORDERS, HIGH_ORDERS or TABLEAUS"
    assert len(made) == len(TABLEAUS)


@each_tableau
def test_every_tableau_lowers(tableau: Tableau) -> None:
    for model in ("mathavan2014", "pooltool"):
        equations = Equations(find_model(model).terms)
        parts = ExactLowering(equations, tableau, Writing(place_fma=True)).parts()
        assert len(parts.stages) == tableau.stages - 1


def test_every_tableau_serves_some_budget() -> None:
    """Emitted, compiled and verified: a loose budget is within reach of two orders, too."""
    tool = bench_tool()
    cases = np.vstack([load_reference().cases, tool.make_cases(20143, 3000, mixed=False).rows])
    exact = tool.expect(cases, "exact", "mathavan2014")
    pairs = [(tableau, budget) for tableau in FAMILY for budget in (1e-2, 1e-6)]
    libraries = built([variant_of_tableau(t, budget, "gcc") for t, budget in pairs])
    served = {}
    for (tableau, budget), library in zip(pairs, libraries, strict=True):
        assert plan_for(budget, tableau.name).tableau is tableau
        verdict = exact_verdict(cases, tool.run_kernel(library, cases), exact, budget)
        print(f"{tableau.name}: {verdict.max_rel_error:.2g} of {budget:g}")
        served.setdefault(tableau.name, []).append("" if verdict.passed else verdict.reason)
    failed = [f"{name}: {reasons}" for name, reasons in served.items() if all(reasons)]
    assert not failed, "\n".join(failed)


def test_a_tableau_is_added_in_one_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """docs/adding-a-stepper.md: here Ralston's method, with Euler's embedded."""
    rows = tuple(tuple(Fraction(word) for word in row.split()) for row in ("", "2/3", "1/4 3/4"))
    embedded = (Fraction(1), Fraction(0), Fraction(0))
    added = Tableau("ralston21", 2, 1, rows, embedded, "Ralston, Math. Comp. 16 (1962) 431")
    test_shape(added)
    test_order_conditions(added)
    monkeypatch.setitem(TABLEAUS, added.name, added)
    made = variant_of_tableau(added, 1e-3, "gcc")
    assert variant_of(name_of(made)) == made
    assert "Ralston, Math. Comp. 16" in emit(made).source


def test_the_files_that_a_stepper_touches_are_there() -> None:
    text = (ROOT / "docs" / "adding-a-stepper.md").read_text("utf-8")
    sections = re.split(r"^## ", text, flags=re.MULTILINE)[1:]
    for section in sections:
        title = section.splitlines()[0]
        files = re.findall(r"^\| `([^`]+)` \|", section.split("one more file:")[0], re.MULTILINE)
        assert int(re.search(r"(\d+) files?$", title)[1]) == len(files), title
        assert all((ROOT / name).exists() for name in files), title
