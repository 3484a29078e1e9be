"""Expressions over the lane vocabulary: written once, for one lane or for many.

Operators and calls build SymPy expressions whose order stays as it is written, so that every
rounding is the author's: `a * b + c` rounds twice, `fma(a, b, c)` once. The one printer prints them
(`ExpressionPrinter`), and `plain` says what they are worth without rounding, as SymPy knows it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from .printer import (
    LANE_WORDS,
    Cast,
    Divide,
    ExpressionPrinter,
    Fma,
    Known,
    Minus,
    Negative,
    Plus,
    Times,
)
from .statements import Assign, lower

Operand = Any  # a Number, or what `exact` takes


def exact(value: int | float | Fraction | sp.Expr) -> sp.Expr:
    """A number as the decimal that it is written as; an expression as it is."""
    if isinstance(value, float):
        return sp.Rational(repr(value))
    if isinstance(value, Fraction):
        return sp.Rational(value.numerator, value.denominator)
    return sp.sympify(value)


@dataclass(frozen=True, eq=False)
class Number:
    """A number in every lane."""

    form: sp.Expr

    def __add__(self, other: Operand) -> Number:
        return _joined(Plus, self, other)

    def __radd__(self, other: Operand) -> Number:
        return _joined(Plus, other, self)

    def __sub__(self, other: Operand) -> Number:
        return _joined(Minus, self, other)

    def __rsub__(self, other: Operand) -> Number:
        return _joined(Minus, other, self)

    def __mul__(self, other: Operand) -> Number:
        return _joined(Times, self, other)

    def __rmul__(self, other: Operand) -> Number:
        return _joined(Times, other, self)

    def __truediv__(self, other: Operand) -> Number:
        return _joined(Divide, self, other)

    def __rtruediv__(self, other: Operand) -> Number:
        return _joined(Divide, other, self)

    def __neg__(self) -> Number:
        return type(self)(Negative(self.form))

    def __lt__(self, other: Operand) -> Mask:
        return Mask(_word("lt", self, other))

    def __le__(self, other: Operand) -> Mask:
        return Mask(_word("le", self, other))

    def __gt__(self, other: Operand) -> Mask:
        return Mask(_word("gt", self, other))

    def __ge__(self, other: Operand) -> Mask:
        return Mask(_word("ge", self, other))


class InLanes(Number):
    """A number that a kernel computes."""


class Fixed(Number):
    """A number that is known when the kernel is compiled: what is made of such numbers is, too."""


@dataclass(frozen=True, eq=False)
class Mask:
    """A truth value in every lane."""

    form: sp.Expr


class Fields:
    """The members of a C++ struct: `Fields("at").c_x` is the number `at.c_x`."""

    def __init__(self, owner: str) -> None:
        self._owner = owner

    def __getattr__(self, name: str) -> Number:
        return number(f"{self._owner}.{name}")

    def mask(self, name: str) -> Mask:
        return mask(f"{self._owner}.{name}")


def number(name: str) -> Number:
    return InLanes(sp.Symbol(name, real=True))


def numbers(names: str) -> tuple[Number, ...]:
    return tuple(number(name) for name in names.split())


def mask(name: str) -> Mask:
    return Mask(sp.Symbol(name, real=True))


def constant(name: str) -> Fixed:
    return Fixed(sp.Symbol(name, real=True))


def given(value: sp.Expr) -> Number:
    """A coefficient: a number, or in masses that are given with the call."""
    return InLanes(value if value.is_number else Cast(value))


def _lane(value: Operand) -> sp.Expr:
    if isinstance(value, Fixed):
        return value.form if value.form.is_number else Known(value.form)
    return value.form if isinstance(value, Number | Mask) else exact(value)


def _joined(how: sp.Function, a: Operand, b: Operand) -> Number:
    if not any(isinstance(x, InLanes) for x in (a, b)):
        return Fixed(how(*(x.form if isinstance(x, Fixed) else exact(x) for x in (a, b))))
    return InLanes(how(_lane(a), _lane(b)))


def _word(name: str, *arguments: Operand) -> sp.Expr:
    return LANE_WORDS[name](*map(_lane, arguments))


def _of_numbers(name: str) -> Callable[..., Number]:
    return lambda *arguments: InLanes(_word(name, *arguments))


def _of_masks(name: str) -> Callable[..., Mask]:
    return lambda *arguments: Mask(_word(name, *arguments))


absolute, larger, smaller = map(_of_numbers, ("absolute", "larger", "smaller"))
rsqrt, rough_rsqrt = map(_of_numbers, ("rsqrt", "rough_rsqrt"))
rough_inverse, near_inverse = map(_of_numbers, ("rough_inverse", "near_inverse"))
sqrt, near_sqrt = map(_of_numbers, ("sqrt", "near_sqrt"))
power_of_two, inverse_of_power = map(_of_numbers, ("power_of_two", "inverse_of_power"))
select, where = map(_of_numbers, ("select", "where"))
both, either, but_not, eq = map(_of_masks, ("both", "either", "but_not", "eq"))


def fma(a: Operand, b: Operand, c: Operand) -> Number:
    """a b + c, rounded once where the kernel places FMAs."""
    return InLanes(Fma(_lane(a), _lane(b), _lane(c)))


def power(x: Operand, sixty_fourths: int | Fixed) -> Number:
    """x^(n/64) to 7 %."""
    n = sixty_fourths.form if isinstance(sixty_fourths, Fixed) else sp.Integer(sixty_fourths)
    return InLanes(LANE_WORDS["power"](_lane(x), n))


def call(name: str, *arguments: Operand) -> Number:
    """A function of the kernel itself."""
    return InLanes(sp.Function(f"call_{name}")(*map(_lane, arguments)))


def _power(x: sp.Expr, n: sp.Expr) -> sp.Expr:
    return x ** (n / 64)


_WORTH: dict[str, Callable[..., sp.Basic]] = {
    "Plus": sp.Add,
    "Minus": lambda a, b: a - b,
    "Times": sp.Mul,
    "Negative": lambda a: -a,
    "Divide": lambda a, b: a / b,
    "Fma": lambda a, b, c: a * b + c,
    **dict.fromkeys(("Known", "Cast", "Group"), lambda a: a),
    "absolute": sp.Abs,
    "larger": sp.Max,
    "smaller": sp.Min,
    "power": _power,
    **dict.fromkeys(("rsqrt", "rough_rsqrt"), lambda a: 1 / sp.sqrt(a)),
    **dict.fromkeys(("rough_inverse", "near_inverse"), lambda a: 1 / a),
    **dict.fromkeys(("sqrt", "near_sqrt"), sp.sqrt),
    "select": lambda m, yes, no: sp.Piecewise((yes, m), (no, True)),
    "lt": sp.Lt,
    "le": sp.Le,
    "gt": sp.Gt,
    "ge": sp.Ge,
}


def plain(value: Number | sp.Basic) -> sp.Basic:
    """What an expression is worth if nothing is rounded."""
    form = value.form if isinstance(value, Number) else value
    if not form.args:
        return form
    worth = _WORTH.get(type(form).__name__, form.func)
    return worth(*map(plain, form.args))


class Lines:
    """Statements as they are written, one after the other."""

    def __init__(self, printer: ExpressionPrinter, real: str = "Real") -> None:
        self._printer, self._real = printer, real
        self._lines: list[str] = []

    def number(self, name: str, value: Operand, note: str = "") -> Number:
        self._put(Assign(name, _lane(value), f"const {self._real}", note))
        return number(name)

    def mask(self, name: str, value: Mask, note: str = "") -> Mask:
        self._put(Assign(name, value.form, "const Mask", note))
        return mask(name)

    def set(self, target: Number | Mask, value: Operand, note: str = "") -> None:
        self._put(Assign(target.form.name, _lane(value), "", note))

    def variable(self, name: str, value: Operand) -> Number:
        """A number that later statements set."""
        self._put(Assign(name, _lane(value), self._real))
        return number(name)

    def returns(self, value: Operand) -> None:
        self._lines.append(f"return {self._printer.print(_lane(value))};")

    def remark(self, *text: str) -> None:
        self._lines += [f"// {line}" for line in text]

    def extend(self, part: tuple[str, ...]) -> None:
        self._lines += part

    def _put(self, assign: Assign) -> None:
        self._lines += lower([assign], self._printer).lines

    def part(self) -> tuple[str, ...]:
        return tuple(self._lines)
