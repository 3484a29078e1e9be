"""Lowering of exact steps: sums of any shape print, and long ones stay quick to lay out."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction

import pytest
import sympy as sp

from generator.emission.kernel_source import KernelSource, emit
from generator.errors import InputError
from generator.impacts.ball_ball import scene as scene_module
from generator.impacts.ball_ball.evidence import MODELS
from generator.impacts.ball_ball.models import find_model
from generator.impacts.ball_ball.scene import parse_scene
from generator.impacts.ball_ball.steppers.exact.step import ExactLowering
from generator.impacts.ball_ball.steppers.exact.writing import Equations, Writing
from generator.lowering.chains import DEEPEST, unfolded
from generator.lowering.printer import ExpressionPrinter, Fma, Plus, decimal_product
from generator.lowering.statements import Assign, lower
from generator.registry.names import variant_of
from generator.tableaus.tableau import Tableau
from generator.tableaus.tableaus import TABLEAUS

TERMS = find_model("mathavan2014").terms
A, B = sp.symbols("a b", real=True)
PRINTER = ExpressionPrinter(True, fma_name="fma")


def chain(links: int) -> sp.Expr:
    """fma(a3, b3, fma(a2, b2, fma(a1, b1, start))) for three links."""
    value: sp.Expr = sp.Symbol("start", real=True)
    for i in range(1, links + 1):
        value = Fma(sp.Symbol(f"a{i}", real=True), sp.Symbol(f"b{i}", real=True), value)
    return value


def test_a_long_chain_becomes_statements_in_the_same_order() -> None:
    block = lower(unfolded(Assign("x", chain(5), "const Real")), PRINTER)
    assert block.lines == ["Real x = start;", *(f"x = fma(a{i}, b{i}, x);" for i in range(1, 6))]
    assert block.counts == PRINTER.print_counted(chain(5))[1]


def test_a_short_chain_stays_one_expression() -> None:
    short = Assign("x", chain(DEEPEST), "const Real")
    assert unfolded(short) == [short]


def test_a_long_chain_inside_an_expression_gets_a_name() -> None:
    inner = Fma(sp.Symbol("h", real=True), chain(4), sp.Symbol("y", real=True))
    block = lower(unfolded(Assign("x", inner, "const Real")), PRINTER)
    assert block.lines[0] == "Real x_sum = start;"
    assert block.lines[-1] == "const Real x = fma(h, x_sum, y);"
    assert block.counts == PRINTER.print_counted(inner)[1]


def test_the_largest_step_holds_no_deep_nest() -> None:
    """clang-format takes 5 s and more for nests of a dop853 step, a moment for statements."""
    parts = ExactLowering(Equations(TERMS), TABLEAUS["dop853"], Writing(place_fma=True))
    whole = parts.parts()
    lines = [*whole.error.lines, *parts.tail().lines]
    for stage in (*whole.stages, *parts.extra_stages()):
        lines += stage.lines
    deepest = max(line.count("fma(") for line in lines)
    print(f"{len(lines)} lines of a dop853 step, at most {deepest} FMAs in one")
    assert deepest <= DEEPEST + 1  # one around a chain that stays an expression


def blind_to_the_tail() -> Tableau:
    """dp54 with an estimate that is a difference of its two stages at the end."""
    dp54 = TABLEAUS["dp54"]
    assert dp54.c[-2:] == (1, 1)
    share = Fraction(1, 40)
    embedded = (*dp54.b[:-2], dp54.b[-2] - share, dp54.b[-1] + share)
    return replace(dp54, name="blind54", embedded=embedded)


def test_an_estimate_that_sees_nothing_of_the_tail_is_refused() -> None:
    lowering = ExactLowering(Equations(TERMS), blind_to_the_tail(), Writing(place_fma=True))
    with pytest.raises(ValueError, match=r"blind54: .* sees nothing of the step into sticking"):
        lowering.tail()


def test_a_stage_made_of_stages_at_the_end_alone_prints_zero() -> None:
    """Rates are zero at the end of the tail, so such a stage stands where the step began."""
    dp54 = TABLEAUS["dp54"]
    a = (*dp54.a[:5], dp54.a[5], (Fraction(0),) * 5 + (Fraction(1),))
    lines = (
        ExactLowering(Equations(TERMS), replace(dp54, name="end54", a=a), Writing(place_fma=True))
        .tail()
        .lines
    )
    assert "const Real z6_x = real(0.0);" in lines
    assert any(line.startswith("const Real z6_r = r_0") for line in lines)


# -- what no operation is needed for --


@pytest.mark.parametrize(
    ("form", "text", "operations"),
    [
        (Fma(-1, A, B), "b - a", "1 add"),
        (Fma(A, -1, B), "b - a", "1 add"),
        (Fma(1, A, B), "b + a", "1 add"),
        (Fma(sp.Float(-1.0), A, B), "b - a", "1 add"),
        (Fma(0, A, B), "b", "none"),
        (Fma(sp.Float(0.0), A, B), "b", "none"),
        (Fma(A, B, 0), "a * b", "1 mul"),
        (Fma(2, A, Fma(-1, B, 0)), "fma(2.0, a, -b)", "1 fma"),
        (Plus(A, 0), "a", "none"),
        (Plus(A, -B), "a - b", "1 add"),
        (Plus(A, sp.Rational(-5, 2) * B), "a - 2.5 * b", "1 add, 1 mul"),
    ],
    ids=str,
)
def test_a_factor_of_one_or_nought_takes_no_operation(
    form: sp.Expr, text: str, operations: str
) -> None:
    printed, counts = PRINTER.print_counted(form)
    print(f"{form}: {printed} ({counts.describe()})")
    assert (printed, counts.describe()) == (text, operations)


def arguments(call: str) -> list[str]:
    """The arguments of a call, from the text behind its opening bracket on."""
    found, depth = [""], 0
    for letter in call:
        depth += (letter in "([{") - (letter in ")]}")
        if depth < 0:
            return [each.strip() for each in found]
        if letter == "," and depth == 0:
            found.append("")
        else:
            found[-1] += letter
    raise AssertionError(f"no end of the call {call[:60]}")


VOID = re.compile(  # 1.0 * x, 0.0 * x; x * 1.0; x + 0.0
    r"(?<![\w.])(?:real\([01]\.0\)|[01]\.0) \* [^;]*"
    r"|[^;]* (?:\* (?:real\()?1|[+-] (?:real\()?0)\.0\b[^;]*"
)
NOTHING_TO_DO = re.compile(r"(?:real\()?-?[01]\.0\)?")


def void_operations(source: str) -> list[str]:
    """FMAs with a factor of 0 or 1, or with nothing to add; products with 1, sums with 0."""
    calls = [arguments(source[m.end() :]) for m in re.finditer(r"\bfma\(", source)]
    fused = [c for c in calls if any(map(NOTHING_TO_DO.fullmatch, c[:2])) or c[2] in NOUGHTS]
    found = [f"fma({', '.join(call)})" for call in fused if call[0] != "Real a"]
    return found + [m[0] for m in VOID.finditer(source)]


NOUGHTS = ("0.0", "real(0.0)", "-0.0", "real(-0.0)")
RECIPES = (
    "e1m06-x1 dp54 root=est2 fma=fma",
    "e1m06-x4 dp54 root=est2 fma=fma lane_root=est2 interleave=s2",
    "e1m06-x8f dp54 root=est2 fma=fma lane_root=est2 interleave=s2",
    "e1m09-x1 dop853 fma=fma",
    "e1m03-x1 ss43",
    "n1000-x1 fixed state=reduced reuse=precompute order=chain rsqrt=est1 roots=early fma=fma "
    "branch=chosen",
)
HEAVY = 'name = "heavy"\ntext = "of a test"\nmass_ratio = 2.5'


@pytest.mark.parametrize(
    ("scene", "model"),
    [*(("any", m) for m in MODELS), ("snooker", MODELS[0]), ("heavy", MODELS[1])],
)
def test_no_kernel_holds_an_operation_that_does_nothing(
    scene: str, model: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("generator.emission.kernel_source.format_source", lambda text, _: text)
    known = {**scene_module.scenes(), "heavy": parse_scene(HEAVY, "heavy.toml")}
    monkeypatch.setattr(scene_module, "scenes", lambda: known)
    legal: list[KernelSource] = []
    for recipe in RECIPES:
        made = variant_of(f"ball-ball/zen3/{scene}/{model}-{recipe}")
        with suppress(InputError, ValueError):
            legal.append(emit(made))
    found = [each for kernel in legal for each in void_operations(kernel.source)]
    print(f"{scene}, {model}: {len(legal)} kernels, {len(found)} void operations: {found[:3]}")
    assert len(legal) >= 3
    assert not found


def test_constants_are_the_decimals_that_they_are_derived_from() -> None:
    assert decimal_product(0.21, 1e-6) == "2.1e-07"
    assert decimal_product(0.42, 1e-6) == "4.2e-07"
    assert decimal_product(1.1, 1.5) == "1.65"
    source = emit(variant_of("ball-ball/zen3/any/pooltool-e1m06-x1 dp54 root=est2 fma=fma")).source
    long_winded = re.findall(r"\b\d\.\d*?(?:00000|99999)\d+(?:e-?\d+)?\b", source)
    print(f"constants such as 2.0999999999999997e-07: {long_winded}")
    assert not long_winded
