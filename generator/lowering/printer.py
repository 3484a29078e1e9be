"""The C++ printer for expressions: one order of operations, FMAs placed or left out by policy.

SymPy's own C++ printer leaves the order of sums to its internal order and knows nothing of FMA; a
kernel's rounding must not depend on either, so the order here is fixed: the terms of a sum as
SymPy sorts them, from the left, and an FMA wherever a product is added if the policy places them.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import sympy as sp

from .counts import OperationCounts

# Functions that a kernel may call, by how they print and what they count as.
Sqrt = sp.Function("Sqrt", real=True)
Divide = sp.Function("Divide", real=True)
Fma = sp.Function("Fma", real=True)
Plus = sp.Function("Plus", real=True)  # a sum whose order stays as written
Minus = sp.Function("Minus", real=True)  # and a difference
Times = sp.Function("Times", real=True)  # and a product
Negative = sp.Function("Negative", real=True)
Group = sp.Function("Group", real=True)  # evaluate this sum or product on its own
Known = sp.Function("Known", real=True)  # in every lane what is known when a kernel is compiled
Cast = sp.Function("Cast", real=True)  # a number as one of the stepper's

# Functions of the lane vocabulary (templates/lanes/README.md). `power` takes 64ths, an integer.
LANE_WORDS = {
    name: sp.Function(name, real=True)
    for name in (
        *("absolute", "larger", "smaller", "select", "where", "power"),
        *("rsqrt", "rough_rsqrt", "rough_inverse", "near_inverse", "sqrt", "near_sqrt"),
        *("power_of_two", "inverse_of_power"),
        *("lt", "le", "gt", "ge", "eq", "both", "either", "but_not"),
    )
}
CALL = "call_"  # begins the name of a SymPy function that is one of the kernel's own


def number(value: sp.Expr, suffix: str = "") -> str:
    """A rational or float as a C++ literal with 17 significant digits, integers as `2.0`."""
    if not value.is_number:
        raise TypeError(f"{value} is no number")
    text = repr(float(value))
    if "e" not in text and "." not in text:
        text += ".0"
    return text + suffix


def _without_fma(a: sp.Expr, b: sp.Expr, c: sp.Expr) -> sp.Expr | None:
    """a * b + c where it takes no FMA: a factor is 0, 1 or -1, or nothing is added; else None."""
    for factor, other in ((a, b), (b, a)):
        if factor.is_number and float(factor) in (-1, 0, 1):
            return Plus(c, int(factor) * other)
    return a * b if c.is_zero else None


def decimal_product(a: float, b: float) -> str:
    """The product of two constants as they are written: 0.21 * 1e-6 is 2.1e-07."""
    return repr(float(Fraction(repr(a)) * Fraction(repr(b))))


class ExpressionPrinter:
    """Prints one expression; `place_fma` decides whether products that are added become FMAs."""

    def __init__(
        self,
        place_fma: bool,
        names: Mapping[str, str] | None = None,
        literal_suffix: str = "",
        fma_name: str = "std::fma",
        number_format: str = "{}",
    ) -> None:
        self.place_fma = place_fma
        self.names = dict(names or {})
        self.literal_suffix = literal_suffix
        self.fma_name = fma_name
        self.number_format = number_format

    def name_of(self, name: str) -> str:
        return self.names.get(name, name)

    def print_counted(self, expression: sp.Expr) -> tuple[str, OperationCounts]:
        text, _, counts = self._print(sp.sympify(expression))
        return text, counts

    def print(self, expression: sp.Expr) -> str:
        return self.print_counted(expression)[0]

    # Each _print method returns (text, binding strength, counts); 3 atom, 2 product, 1 sum.
    def _print(self, e: sp.Expr) -> tuple[str, int, OperationCounts]:
        if e.is_Symbol:
            return self.name_of(e.name), 3, OperationCounts()
        if e.is_Rational or e.is_Float:
            return self._number(e)
        if e.is_Add:
            return self._sum(e)
        if e.is_Mul:
            return self._product(e)
        if e.is_Pow:
            return self._power(e)
        if e.is_Function:
            return self._call(e)
        raise TypeError(f"the printer does not know {type(e).__name__}: {e}")

    def _number(self, e: sp.Expr) -> tuple[str, int, OperationCounts]:
        text = self._literal(e)
        return text, 1 if text.startswith("-") else 3, OperationCounts()

    def _literal(self, e: sp.Expr) -> str:
        return self.number_format.format(number(e, self.literal_suffix))

    def _wrapped(self, e: sp.Expr, strength: int) -> tuple[str, OperationCounts]:
        text, own, counts = self._print(e)
        return (f"({text})" if own < strength else text), counts

    def _call(self, e: sp.Expr) -> tuple[str, int, OperationCounts]:
        name = type(e).__name__
        if name == "Group":
            text, _, counts = self._print(e.args[0])
            return f"({text})", 3, counts
        if name == "Plus":
            return self._plus(*e.args)
        if name in ("Times", "Minus", "Negative", "Known", "Cast"):
            return self._as_written(name, *e.args)
        if name in LANE_WORDS or name.startswith(CALL):
            return self._word(name.removeprefix(CALL), e.args)
        if name == "Fma" and (plain := _without_fma(*e.args)) is not None:
            return self._print(plain)
        if name == "Divide":
            top, counts_top = self._wrapped(e.args[0], 2)
            bottom, counts_bottom = self._wrapped(e.args[1], 3)
            return f"{top} / {bottom}", 2, counts_top + counts_bottom + OperationCounts(div=1)
        spelled = {
            "Sqrt": ("std::sqrt", OperationCounts(sqrt=1)),
            "Fma": (self.fma_name, OperationCounts(fma=1)),
        }
        if name not in spelled:
            raise TypeError(f"the printer does not know the function {name}")
        spelling, counts = spelled[name]
        texts = []
        for argument in e.args:
            text, _, own = self._print(argument)
            texts.append(text)
            counts = counts + own
        return f"{spelling}({', '.join(texts)})", 3, counts

    def _as_written(self, name: str, *args: sp.Expr) -> tuple[str, int, OperationCounts]:
        if name in ("Known", "Cast"):
            inner = self._plain_numbers() if name == "Known" else self
            text, counts = inner.print_counted(args[0])
            return self.number_format.format(text), 3, counts
        if name == "Negative":
            text, counts = self._wrapped(args[0], 3)
            return f"-{text}", 3, counts
        left, right = 2 if name == "Times" else 1, 3 if name == "Times" else 2
        (first, own), (second, others) = (
            self._wrapped(args[0], left),
            self._wrapped(args[1], right),
        )
        if name == "Times":
            return f"{first} * {second}", 2, own + others + OperationCounts(mul=1)
        return f"{first} - {second}", 1, own + others + OperationCounts(add=1)

    def _plain_numbers(self) -> ExpressionPrinter:
        return ExpressionPrinter(self.place_fma, self.names, self.literal_suffix, self.fma_name)

    def _word(self, name: str, args: tuple[sp.Expr, ...]) -> tuple[str, int, OperationCounts]:
        """A call of the lane vocabulary, which is counted by what it gets alone."""
        printed = [
            (str(a), OperationCounts())
            if a.is_Integer and name == "power"
            else self.print_counted(a)
            for a in args
        ]
        counts = sum((own for _, own in printed), OperationCounts())
        return f"{name}({', '.join(text for text, _ in printed)})", 3, counts

    def _plus(self, first: sp.Expr, second: sp.Expr) -> tuple[str, int, OperationCounts]:
        if first.is_zero or second.is_zero:
            return self._print(second if first.is_zero else first)
        left, _, counts_left = self._print(first)
        negative = second.as_coeff_Mul()[0].is_negative
        right, counts_right = self._wrapped(-second if negative else second, 2)
        counts = counts_left + counts_right + OperationCounts(add=1)
        return f"{left} {'-' if negative else '+'} {right}", 1, counts

    def _power(self, e: sp.Expr) -> tuple[str, int, OperationCounts]:
        base, exponent = e.args
        if not exponent.is_Integer or exponent == 0:
            raise TypeError(f"the printer knows whole powers only, not {e}")
        text, counts = self._wrapped(base, 3)
        size = abs(int(exponent))
        if size > 1 and not base.is_Symbol:
            raise TypeError(f"give {base} a name before raising it to a power")
        product = " * ".join([text] * size)
        counts = counts + OperationCounts(mul=size - 1)
        if exponent > 0:
            return product, 2 if size > 1 else 3, counts
        product = f"({product})" if size > 1 else product
        return (
            f"{self._literal(sp.Integer(1))} / {product}",
            2,
            counts + OperationCounts(div=1),
        )

    def _factors(self, e: sp.Expr) -> tuple[bool, list[sp.Expr], list[sp.Expr]]:
        """Sign, numerator and denominator factors of a product, coefficient first."""
        coefficient, rest = e.as_coeff_Mul()
        negative = bool(coefficient.is_number and coefficient < 0)
        coefficient = abs(coefficient)
        above: list[sp.Expr] = [] if coefficient == 1 else [coefficient]
        below: list[sp.Expr] = []
        for factor in rest.as_ordered_factors() if rest != 1 else []:
            if factor.is_Pow and factor.exp.is_Integer and factor.exp < 0:
                below.append(factor.base ** (-factor.exp))
            else:
                above.append(factor)
        return negative, above, below

    def _product_of(self, factors: list[sp.Expr]) -> tuple[str, OperationCounts]:
        texts, counts = [], OperationCounts()
        for factor in factors:
            text, own = self._wrapped(factor, 3 if factor.is_Pow is False else 2)
            texts.append(text)
            counts = counts + own
        if not texts:
            return self._literal(sp.Integer(1)), counts
        return " * ".join(texts), counts + OperationCounts(mul=len(texts) - 1)

    def _product(self, e: sp.Expr) -> tuple[str, int, OperationCounts]:
        negative, above, below = self._factors(e)
        text, counts = self._product_of(above)
        if below:
            bottom, own = self._product_of(below)
            bottom = f"({bottom})" if len(below) > 1 or below[0].is_Pow else bottom
            text, counts = f"{text} / {bottom}", counts + own + OperationCounts(div=1)
        if negative:
            return f"-{text}", 1, counts
        return text, 2 if len(above) + len(below) > 1 else 3, counts

    def _sum(self, e: sp.Expr) -> tuple[str, int, OperationCounts]:
        terms = sorted(e.as_ordered_terms(), key=self._starts_sum, reverse=True)
        return self._fma_sum(terms) if self.place_fma else self._plain_sum(terms)

    @staticmethod
    def _starts_sum(term: sp.Expr) -> tuple[bool, bool]:
        """Terms that need no product and are positive come first (stable otherwise)."""
        plain = not term.is_Mul or (-term).is_Symbol
        return plain, not term.could_extract_minus_sign()

    def _plain_sum(self, terms: list[sp.Expr]) -> tuple[str, int, OperationCounts]:
        text, _, counts = self._print(terms[0])
        for term in terms[1:]:
            negative = term.could_extract_minus_sign()
            own_text, own = self._wrapped(-term if negative else term, 2)
            text += f" {'-' if negative else '+'} {own_text}"
            counts = counts + own + OperationCounts(add=1)
        return text, 1, counts

    def _fma_sum(self, terms: list[sp.Expr]) -> tuple[str, int, OperationCounts]:
        text, strength, counts = self._print(terms[0])
        for term in terms[1:]:
            split = self._two_factors(term)
            if split is None:
                negative = term.could_extract_minus_sign()
                own_text, own = self._wrapped(-term if negative else term, 2)
                text = f"{text} {'-' if negative else '+'} {own_text}"
                counts, strength = counts + own + OperationCounts(add=1), 1
                continue
            (left, left_counts), (right, right_counts) = split
            text, strength = f"{self.fma_name}({left}, {right}, {text})", 3
            counts = counts + left_counts + right_counts + OperationCounts(fma=1)
        return text, strength, counts

    def _two_factors(
        self, term: sp.Expr
    ) -> tuple[tuple[str, OperationCounts], tuple[str, OperationCounts]] | None:
        """A product as (all but the last factor, last factor), the sign on the first; else None."""
        if term.is_Pow and term.exp == 2 and term.base.is_Symbol:
            name = self.name_of(term.base.name)
            return (name, OperationCounts()), (name, OperationCounts())
        if not term.is_Mul:
            return None
        negative, above, below = self._factors(term)
        if below or len(above) < 2:
            return None
        left, left_counts = self._product_of(above[:-1])
        right, right_counts = self._print(above[-1])[::2]
        if negative:
            left = f"-{left}" if above[0].is_number or len(above) == 2 else f"-({left})"
        return (left, left_counts), (right, right_counts)
