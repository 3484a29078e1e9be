"""Fixed steps with a certificate: tableau, ends, tables, and that tiers are what the page says."""

from __future__ import annotations

import random
import re
from collections.abc import Mapping
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from generator.errors import KernelError
from generator.evidence.timing.bench_tool import ROOT
from generator.impacts.ball_ball.evidence.measure import errors_of
from generator.impacts.ball_ball.masses import EQUAL, pressed_changes
from generator.impacts.ball_ball.models import MODELS, find_model
from generator.impacts.ball_ball.steppers.exact.pressed import Pressed
from generator.impacts.ball_ball.steppers.tiers.lookup import bound_for
from generator.impacts.ball_ball.steppers.tiers.sticking import rates, slips
from generator.impacts.ball_ball.steppers.tiers.whole import end_weights, stage, stage_alone
from generator.impacts.ball_ball.tiers import has_bound, has_sticking
from generator.registry.rules import broken_rule
from generator.registry.variant import Stepper as Exact
from generator.registry.variant import Variant, make_variant
from generator.tableaus.plain import BUTCHER_6, KUTTA_4, PlainTableau
from generator.targets.host import read_host
from generator.targets.target import find_target
from tests.steppers.test_tableaus import residual
from tests.support.exact_kernels import built, exact_variant
from tests.support.kernels import bench_tool, build_all

BUDGETS = (1e-3, 1e-4, 1e-6, 9e-7, 1e-9)


TABLEAUS = (BUTCHER_6, KUTTA_4)


def _padded(tableau: PlainTableau) -> tuple[tuple[Fraction, ...], ...]:
    return tuple((*row, *[Fraction()] * (i - len(row))) for i, row in enumerate(tableau.a))


@pytest.mark.parametrize("tableau", TABLEAUS, ids=lambda t: t.name)
@pytest.mark.parametrize("nodes", range(1, 8))
def test_the_tableau_has_the_order_that_it_says(tableau: PlainTableau, nodes: int) -> None:
    off = float(residual(tableau.b, _padded(tableau), nodes))
    print(f"trees of {nodes} nodes: off by at most {off:.1e}")
    assert (off < 1e-38) == (nodes <= tableau.order)


@pytest.mark.parametrize("tableau", TABLEAUS, ids=lambda t: t.name)
def test_the_last_stages_stand_at_the_nodes(tableau: PlainTableau) -> None:
    for at, node in zip(tableau.node_stages, tableau.nodes, strict=True):
        assert abs(tableau.c[at] - node) < Fraction(1, 10**38)


@pytest.mark.parametrize("tableau", TABLEAUS, ids=lambda t: t.name)
@pytest.mark.parametrize("power", range(4))
def test_the_work_of_compression_is_exact_for_cubics(tableau: PlainTableau, power: int) -> None:
    """Sums and double sums until w = 1 / (1 + e_b) of the powers that the nodes determine."""
    weights = {name: sp.sympify(text) for name, text in end_weights(tableau)}
    w, nodes = sp.Symbol("w"), [float(node) for node in tableau.nodes]
    for share in (0.5, 0.7, 1.0):
        once = sum(float(weights[f"t{i}"].subs(w, share)) * n**power for i, n in enumerate(nodes))
        twice = sum(float(weights[f"i{i}"].subs(w, share)) * n**power for i, n in enumerate(nodes))
        assert once == pytest.approx(share ** (power + 1) / (power + 1), abs=1e-14)
        exact = share ** (power + 2) / ((power + 1) * (power + 2))
        assert twice == pytest.approx(exact, abs=1e-14)


@pytest.mark.parametrize("model", MODELS, ids=lambda m: m.name)
def test_the_registry_knows_for_what_there_are_certificates(model) -> None:
    for budget in BUDGETS:
        try:
            bound = bound_for(model.terms, budget)
        except ValueError:
            bound = None
        assert has_bound(model.name, budget) == (bound is not None), budget


@pytest.mark.parametrize("model", MODELS, ids=lambda m: m.name)
def test_the_registry_knows_for_what_steps_into_sticking_are_known(model) -> None:
    for budget in BUDGETS:
        known = has_bound(model.name, budget) and bound_for(model.terms, budget).sticks is not None
        assert has_sticking(model.name, budget) == known, budget


def test_the_rates_into_sticking_are_those_of_the_equations() -> None:
    """Along y, from the slips that t_x, t_y and r say; c_x by what r, bend and star make of it."""
    pressed = Pressed.of(pressed_changes(find_model("mathavan2014").terms, EQUAL))
    names = "r m on.star square on.size on.start.u_s steep wide on.along on.pull on.press"
    at = {name: random.Random(name).uniform(0.1, 1) for name in names.split()}
    found = _values(
        (*slips(pressed), *rates(pressed)), at | {"per_m": 1 / at["m"], "kTinySquare": 0.0}
    )
    k_x, u_s = float(pressed.k_x), at["on.start.u_s"]
    u_x, u_y = found["u_x"], found["u_y"]
    falls = float(pressed.k_z) - float(pressed.k_zt) * u_s * u_y  # of log c_z, in w
    ratio = at["r"] * at["m"] + at["on.star"]
    slope = -(k_x - falls) * ratio - float(pressed.k_xt) * u_s * u_x  # of c_x / c_z, in w
    bends = (at["on.along"] - 1) * falls * at["r"] * at["m"]  # what y^bend makes of it
    pace = at["wide"] / falls
    assert u_x**2 + u_y**2 == pytest.approx(1)
    assert found["left"] == pytest.approx(at["square"] * at["on.size"])
    assert found["d_t_x"] == pytest.approx(at["on.pull"] * u_x * pace)
    assert found["d_t_y"] == pytest.approx(at["on.pull"] * u_y * pace)
    assert found["d_q"] == pytest.approx(at["on.press"] * (1 + ratio**2) ** 0.5 * pace)
    assert found["d_r"] == pytest.approx(at["steep"] * (slope + bends) / (falls * at["m"]))


def test_the_length_of_one_step_is_exact_to_first_order() -> None:
    """Q of docs/fixed-tiers.md for friction that goes from f_0 to f_1 along the line of centres."""
    e, f_0, f_1, small = sp.symbols("e f_0 f_1 small", positive=True)
    q, end, x = sp.symbols("q end x", positive=True)
    first, last = (3 + 5 * e) / 24, (3 + e) / 24
    length = (1 + e) / 2 - small * (first * f_0 + last * f_1)
    t = small * (f_0 + (f_1 - f_0) * x / length)
    v = -1 + 2 * q + sp.integrate(t, (x, 0, q))
    work = sp.integrate(sp.expand(v.subs(q, x) * t), (x, 0, end))
    q_c = length / (1 + e)
    square = e**2 + 2 * work.subs(end, length) - 2 * (1 - e**2) * work.subs(end, q_c)
    off = sp.series(v.subs(q, length) ** 2 - square, small, 0, 2).removeO()
    assert sp.simplify(off) == 0


def _values(lines: tuple[str, ...], given: Mapping[str, float] | None = None) -> dict[str, float]:
    """What C++ computes of numbers that are given, or else drawn by their names."""
    found: dict[str, float] = {}
    names = {
        "real": float,
        "fma": lambda a, b, c: a * b + c,
        "rsqrt": lambda x: x**-0.5,
        "near_inverse": lambda x: 1 / x,
    }
    for line in lines:
        match = re.fullmatch(r"const Real (\w+) = (.*?);( +//.*)?|//.*", line)
        assert match is not None, line
        if match[1] is None:
            continue
        text = match[2]
        for name in set(re.findall(r"\b[a-z]\w*(?:\.\w+)*", text)) - set(names) - set(found):
            if not name[0].isdigit():
                drawn = random.Random(name).uniform(-1, 1)
                value = (given or {}).get(name, drawn)
                text = re.sub(rf"(?<![\w.]){re.escape(name)}(?![\w.])", f"({value!r})", text)
        found[match[1]] = eval(text, names | found)
    return found


def _variants() -> list[Variant]:
    found = []
    for target, width, fma in (("x86-64-v3", 8, "fma"), ("x86-64-v4", 16, "fma")):
        if not read_host().runs(find_target(target)):
            continue
        options = {"root": "est1", "fma": fma, "numbers": "float", "interleave": "s2"}
        made = make_variant(
            target, "any", "mathavan2014", Exact("dp54", budget=1e-6), width, **options
        )
        found += [made, made.with_options(lane_tiers="fixed")]
    return found


def test_fixed_steps_are_as_exact_as_adaptive_ones() -> None:
    """All kinds, over the whole range of speeds, through both kernels of each width."""
    tool, variants = bench_tool(), _variants()
    cases = tool.make_cases(31, 20000, mixed=False)
    want = tool.expect(cases.rows, "exact", "mathavan2014")
    for variant, library in zip(variants, build_all(variants), strict=True):
        assert not isinstance(library, KernelError), library
        got = tool.run_kernel(library.path, cases.rows, batch=True)
        relative = errors_of(cases.rows, got, want).relative
        worst = int(np.argmax(relative))
        print(f"{variant.recipe}: {relative[worst]:.2g} ({cases.kinds[worst]})")
        assert relative[worst] <= 1e-6


@pytest.mark.parametrize(
    ("model", "budget", "compiler", "tiers"),
    [
        ("mathavan2014", 1e-6, "gcc", "fixed"),
        ("mathavan2014", 1e-6, "clang", "sticking"),
        ("bottom_slip", 1e-6, "gcc", "sticking"),
        ("pooltool", 1e-6, "gcc", "sticking"),
        ("bottom_slip", 1e-3, "clang", "fixed"),
        ("pooltool", 1e-3, "gcc", "fixed"),
    ],
)
def test_fixed_steps_of_single_calls_hold_the_budget(
    model: str, budget: float, compiler: str, tiers: str
) -> None:
    tool = bench_tool()
    made = exact_variant(model, budget, compiler).with_options(tiers=tiers)
    cases = tool.make_cases(32, 20000, mixed=False)
    want = tool.expect(cases.rows, "screen", model)
    got = tool.run_kernel(built([made])[0], cases.rows)
    relative = errors_of(cases.rows, got, want).relative
    worst = int(np.argmax(relative))
    print(f"{made.recipe}: {relative[worst]:.2g} ({cases.kinds[worst]})")
    assert relative[worst] <= budget


@pytest.mark.parametrize(
    ("model", "budget", "kind"),
    [
        ("mathavan2014", 1e-6, "sticking"),
        ("bottom_slip", 1e-3, "fixed"),
        ("pooltool", 1e-3, "fixed"),
        ("pooltool", 1e-4, "sticking"),
    ],
)
def test_fixed_steps_in_lanes_hold_the_budget(model: str, budget: float, kind: str) -> None:
    tool = bench_tool()
    alone = exact_variant(model, budget, "clang")
    ways = {"numbers": "float", "interleave": "s2", "lane_root": alone["root"]}
    made = alone.in_lanes(8, lane_tiers=kind, **ways)
    assert broken_rule(made, find_target(made.target)) is None
    cases = tool.make_cases(33, 5000, mixed=False)
    want = tool.expect(cases.rows, "screen", model)
    got = tool.run_kernel(built([made])[0], cases.rows, batch=True)
    relative = errors_of(cases.rows, got, want).relative
    worst = int(np.argmax(relative))
    print(f"{made.recipe}: {relative[worst]:.2g} ({cases.kinds[worst]})")
    assert relative[worst] <= budget


def test_the_stages_of_single_calls_are_those_of_lanes() -> None:
    """Slips at each stage, from the same rates, in exact numbers."""
    terms, tableau = find_model("mathavan2014").terms, BUTCHER_6
    pressed = Pressed.of(pressed_changes(terms, EQUAL))
    for i in range(1, tableau.stages):
        ways = [made(tableau, pressed, i) for made in (stage, stage_alone)]
        one, other = (_values(lines) for lines in ways)
        for name in ("y_c_x", "y_c_z", "y_s_x", "y_s_y", *(("v",) if tableau.b[i] else ())):
            assert one[name] == pytest.approx(other[name], abs=1e-13)


@pytest.mark.parametrize("budget", (1e-3, 1e-6))
def test_collisions_without_restitution_hold_the_budget(budget: float) -> None:
    """In one step or by adaptive ones, they end with v_n = 0."""
    tool = bench_tool()
    made = exact_variant("mathavan2014", budget).with_options(tiers="fixed")
    cases = tool.make_cases(35, 20000, mixed=False, fixed={"e_b": 0.0}).rows
    want = tool.expect(cases, "screen", "mathavan2014")
    got = tool.run_kernel(built([made])[0], cases)
    largest = errors_of(cases, got, want).relative.max()
    print(f"largest error {largest:.2g}")
    assert largest <= budget


def test_only_floats_in_plain_scenes_take_them() -> None:
    target = find_target("x86-64-v4")
    made = make_variant(
        "x86-64-v4", "any", "mathavan2014", Exact("dp54", budget=1e-6), 8, fma="fma"
    )
    in_floats = made.in_lanes(16, numbers="float", interleave="s2", lane_tiers="fixed")
    alone = made.in_lanes(1).with_options(root="inv", tiers="fixed")
    tight = make_variant(
        "x86-64-v4", "any", "pooltool", Exact("dop853", budget=1e-9), 1, root="inv", tiers="fixed"
    )
    cases = {
        "": in_floats,
        "tiers-need-a-bound": tight,
        "tiers-need-equal-balls": alone.moved(scene="unequal"),
        "lane-tiers-need-a-plain-scene": in_floats.moved(scene="break"),
        "lane-tiers-are-in-floats": made.with_options(lane_tiers="fixed"),
    }
    for name, variant in cases.items():
        rule = broken_rule(variant, target)
        assert (rule.name if rule else "") == name


def test_the_page_has_the_constants_of_the_code() -> None:
    page = (ROOT / "docs" / "fixed-tiers.md").read_text("utf-8")
    bound = bound_for(MODELS[[m.name for m in MODELS].index("mathavan2014")].terms, 1e-6)
    for room, where in (
        (bound.error, "in lanes of floats"),
        (bound.error_alone, "in single calls"),
    ):
        assert f"{room:g} {where}".replace("e-0", "e-") in page
    assert [tier.steps for tier in bound.tiers] == [0, 1, 2, 4]
