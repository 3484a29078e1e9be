"""Lowering of exact steps: sums of any shape print, and long ones stay quick to lay out."""

from __future__ import annotations

import time
from dataclasses import replace
from fractions import Fraction

import pytest
import sympy as sp

from generator.emission.formatting import format_source
from generator.lowering.chains import DEEPEST, unfolded
from generator.lowering.exact_step import ExactLowering
from generator.lowering.printer import ExpressionPrinter, Fma
from generator.lowering.statements import Assign, lower
from generator.scenes.models import find_model
from generator.steppers.tableaus import TABLEAUS, Tableau

TERMS = find_model("mathavan2014").terms
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


def test_the_largest_step_is_laid_out_in_a_moment() -> None:
    parts = ExactLowering(TERMS, TABLEAUS["dop853"], True)
    whole = parts.parts()
    lines = [*whole.error.lines, *parts.tail().lines]
    for stage in (*whole.stages, *parts.extra_stages()):
        lines += stage.lines
    text = "void f() {\n" + "\n".join(lines) + "\n}\n"
    start = time.monotonic()
    format_source(text, "f.cpp")
    took = time.monotonic() - start
    print(f"{len(lines)} lines of a dop853 step laid out in {took:.2f} s (nested: 5 s and more)")
    assert took < 3


def blind_to_the_tail() -> Tableau:
    """dp54 with an estimate that is a difference of its two stages at the end."""
    dp54 = TABLEAUS["dp54"]
    assert dp54.c[-2:] == (1, 1)
    share = Fraction(1, 40)
    embedded = (*dp54.b[:-2], dp54.b[-2] - share, dp54.b[-1] + share)
    return replace(dp54, name="blind54", embedded=embedded)


def test_an_estimate_that_sees_nothing_of_the_tail_is_refused() -> None:
    lowering = ExactLowering(TERMS, blind_to_the_tail(), True)
    with pytest.raises(ValueError, match=r"blind54: .* sees nothing of the step into sticking"):
        lowering.tail()


def test_a_stage_made_of_stages_at_the_end_alone_prints_zero() -> None:
    """Rates are zero at the end of the tail, so such a stage stands where the step began."""
    dp54 = TABLEAUS["dp54"]
    a = (*dp54.a[:5], dp54.a[5], (Fraction(0),) * 5 + (Fraction(1),))
    lines = ExactLowering(TERMS, replace(dp54, name="end54", a=a), True).tail().lines
    assert "const Real z6_x = real(0.0);" in lines
    assert any(line.startswith("const Real z6_r = r_0") for line in lines)
