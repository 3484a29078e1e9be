"""Step control is arithmetic of Python: templates lay out, docs/step-control.md says the same."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator

import pytest
import sympy as sp

from generator.emission.environment import templates_folder
from generator.evidence.timing.bench_tool import ROOT
from generator.impacts.ball_ball.masses import EQUAL, pressed_changes
from generator.impacts.ball_ball.models import find_model
from generator.impacts.ball_ball.steppers.exact.constants import table
from generator.impacts.ball_ball.steppers.exact.lengths import PRINTER, plan_lines
from generator.impacts.ball_ball.steppers.exact.passage import passage_lines
from generator.impacts.ball_ball.steppers.exact.pressed import Pressed
from generator.lowering.lane_algebra import Lines, constant, number, plain
from generator.lowering.statements import Assign

PAGE = ROOT / "docs" / "step-control.md"
FOLDERS = ("ball_ball/exact", "ball_ball/fixed_step", "ball_ball/sections", "lanes", "sections")
FREE = {"0", "1", "2", "0.0", "1.0", "2.0", "0.5"}
# What is left: lines of a template with another number, or with arithmetic. Only ever smaller.
LEFT = {
    "ball_ball/exact/flight.j2": 42,
    "ball_ball/exact/frame.j2": 43,
    "ball_ball/exact/free.j2": 22,
    "ball_ball/exact/interpolant.j2": 9,
    "ball_ball/exact/joint_error.j2": 2,
    "ball_ball/exact/level.j2": 4,
    "ball_ball/exact/level_batch.j2": 5,
    "ball_ball/exact/macros.j2": 2,
    "ball_ball/exact/passed.j2": 1,
    "ball_ball/exact/pressed.j2": 13,
    "ball_ball/exact/queue.j2": 2,
    "ball_ball/exact/relative.j2": 1,
    "ball_ball/exact/scale.j2": 2,
    "ball_ball/exact/single.j2": 2,
    "ball_ball/exact/stages.j2": 2,
    "ball_ball/exact/step.j2": 26,
    "ball_ball/exact/system.j2": 6,
    "ball_ball/fixed_step/ball_lanes.j2": 10,
    "ball_ball/fixed_step/chosen.j2": 1,
    "ball_ball/fixed_step/core.j2": 3,
    "ball_ball/fixed_step/helpers/estimate.j2": 2,
    "ball_ball/fixed_step/helpers/exact_rsqrt.j2": 2,
    "ball_ball/fixed_step/helpers/masked.j2": 1,
    "ball_ball/fixed_step/helpers/pair.j2": 1,
    "ball_ball/fixed_step/helpers/refined.j2": 5,
    "ball_ball/fixed_step/lanes/block.j2": 47,
    "ball_ball/fixed_step/lanes/chatter.j2": 12,
    "ball_ball/fixed_step/lanes/level.j2": 1,
    "ball_ball/fixed_step/lanes/loop.j2": 30,
    "ball_ball/fixed_step/lanes/steady.j2": 11,
    "ball_ball/fixed_step/level.j2": 3,
    "ball_ball/fixed_step/macros.j2": 9,
    "ball_ball/fixed_step/slip_lanes.j2": 8,
    "ball_ball/sections/batch_enter.j2": 30,
    "ball_ball/sections/batch_leave.j2": 6,
    "ball_ball/sections/frame.j2": 24,
    "ball_ball/sections/leave.j2": 4,
    "lanes/avx2.j2": 18,
    "lanes/interleaved.j2": 10,
    "lanes/near_sqrt.j2": 3,
    "lanes/neon.j2": 1,
    "lanes/packings.j2": 2,
    "lanes/roots.j2": 15,
    "lanes/scalar.j2": 1,
    "lanes/scalar_more.j2": 1,
    "lanes/simd128.j2": 3,
    "lanes/sse2.j2": 1,
    "lanes/vector_bits.j2": 6,
    "sections/abi.j2": 1,
}

_QUIET = re.compile(r"\{#.*?#\}|\{%.*?%\}|\{\{.*?\}\}|//[^\n]*|\"[^\"\n]*\"", re.S)
_NUMBER = re.compile(r"(?<![\w.])(?:0x[\da-fA-F]+u?|\d+\.?\d*(?:e-?\d+)?)(?![\w.])")
# An operator between two operands; a pointer's or a reference's star stands after a type's name.
_BETWEEN = re.compile(r"(?<=[\w)\]]) [-+*/] (?=[\w(-])|[-+*/]=")
_SIGN = re.compile(r"(?:[(,=?:]|return) ?-(?=[a-z(])")


def _quiet(text: str) -> str:
    return _QUIET.sub(lambda m: "x" if m.group().startswith("{{") else "", text)


def _counted(text: str) -> Iterator[str]:
    """Lines with another number or with arithmetic, integers that count lanes included.

    What Jinja, comments and strings hold does not count: x is what a Jinja expression leaves.
    """
    for line in _quiet(text).splitlines():
        numbers = set(_NUMBER.findall(line)) - FREE
        if not line.startswith("#") and (numbers or _BETWEEN.search(line) or _SIGN.search(line)):
            yield line.strip()


def test_no_template_has_numbers_or_arithmetic_but_those_that_are_left() -> None:
    found = {}
    for folder in FOLDERS:
        for path in sorted((templates_folder() / folder).rglob("*.j2")):
            if lines := list(_counted(path.read_text("utf-8"))):
                found[f"{folder}/{path.relative_to(templates_folder() / folder)}"] = len(lines)
    print(found)
    assert found == LEFT, (
        "fewer: lower LEFT; more: form it in Python (steppers/exact/lengths.py of the impact)"
    )


def test_templates_of_the_exact_steppers_have_no_constant_of_their_own() -> None:
    own = {}
    for path in sorted((templates_folder() / "ball_ball" / "exact").glob("*.j2")):
        found = set(_NUMBER.findall(_quiet(path.read_text("utf-8")))) - FREE
        own[path.name] = {n for n in found if "x" not in n and ("." in n or "e" in n)}
    assert not any(own.values()), own


def _forms(pressed: Pressed, monkeypatch: pytest.MonkeyPatch) -> dict[str, sp.Basic]:
    """What the statements of a plan set, without rounding, by name; the last of a name."""
    found: dict[str, sp.Basic] = {}
    put = Lines._put

    def noting(self: Lines, assign: Assign) -> None:
        form = plain(assign.value)
        short = {s: _short(s.name) for s in form.free_symbols}
        found[assign.target.split(".")[-1]] = form.xreplace(short)
        put(self, assign)

    monkeypatch.setattr(Lines, "_put", noting)
    plan_lines(pressed, (), False)
    passage_lines(pressed)
    return found


def _short(name: str) -> sp.Expr:
    """at.c_x as the page has it: c_x; what keeps a square from zero is nothing there."""
    return sp.Integer(0) if name == "kTinySquare" else _symbol(name.split(".")[-1])


def _symbol(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


def _on_the_page(formula: str, pressed: Pressed) -> sp.Expr:
    values = {n: getattr(pressed, n) for n in ("k_x", "k_z", "k_zt")}
    words = {"min": sp.Min, "max": sp.Max, "Abs": sp.Abs}
    free = {n: _symbol(n) for n in re.findall(r"[A-Za-z]\w*", formula)}
    return sp.sympify(formula, locals={**free, **values, **words})


def _same(page: sp.Expr, code: sp.Expr) -> bool:
    """Equal at random places: Min, Max, Abs and roots have no normal form."""
    free = sorted(page.free_symbols | code.free_symbols, key=str)
    chance = random.Random(7)
    for _ in range(20):
        place = {s: chance.uniform(0.1, 2) for s in free}
        place.update({_symbol("within"): sp.false, _symbol("kOrder"): 13})
        if abs(page.subs(place).evalf() / code.subs(place).evalf() - 1) > 1e-9:
            return False
    return True


def test_the_code_computes_the_formulas_of_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    pressed = Pressed.of(pressed_changes(find_model("mathavan2014").terms, EQUAL))
    forms = _forms(pressed, monkeypatch)
    formulas = dict(re.findall(r"^    (\w+) = (.+)$", PAGE.read_text("utf-8"), re.M))
    assert len(formulas) >= 10
    for name, formula in formulas.items():
        page = _on_the_page(formula, pressed)
        assert _same(page, forms[name]), f"{name}: {page} on the page, {forms[name]} in the code"


def test_the_page_has_every_constant() -> None:
    text = PAGE.read_text("utf-8")
    for name, value in table():
        shown = value.form.name if value.form.is_Symbol else name
        cells = [f"`{shown}`", value.unit, value.reason, value.measured]
        if not value.form.is_Symbol:
            cells[2] = f"{float(value.form):g}: {value.reason}"
        row = "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
        assert row in text, f"{PAGE.name} has no row\n{row}"


def test_orders_stay_as_they_are_written() -> None:
    a, b, c = number("a"), number("b"), number("c")
    value = c + a * b - 2 * (a + b) / c
    assert PRINTER.print(value.form) == "c + a * b - real(2.0) * (a + b) / c"
    assert plain(a * b + c) == a.form * b.form + c.form
    assert PRINTER.print((a > 2 * constant("kOne")).form) == "gt(a, real(2.0 * kOne))"
