"""What an explicit Runge-Kutta tableau with embedded error estimates is, in exact rationals."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

Row = tuple[Fraction, ...]


def row(text: str, total: str = "") -> Row:
    """Weights; with a total, `_` comes first and is what the others leave of it.

    Coefficients published as rounded numbers then satisfy at least the row sums exactly.
    """
    words = text.split()
    if not total:
        return tuple(Fraction(word) for word in words)
    others = tuple(Fraction(word) for word in words[1:])
    return (Fraction(total) - sum(others), *others)


@dataclass(frozen=True)
class Tableau:
    """An explicit method of `order` with an embedded one of `embedded_order`.

    `a` is lower triangular, row i the weights of stages 0..i-1. The last row of `a` equals `b`
    (first same as last): its stage is the first of the next step.
    """

    name: str
    order: int
    embedded_order: int
    a: tuple[Row, ...]
    embedded: Row  # weights of the embedded method, one a stage
    source: str
    dense: tuple[Row, ...] = ()  # the interpolant's coefficients beyond the cubic of Hermite
    extra: tuple[Row, ...] = ()  # further stages, for the interpolant alone
    second: Row = ()  # weights of a second, coarser embedded method that steadies the estimate
    work_share: float = (
        2.5  # most error of a work over what is seen (tests/steppers/test_tail_work)
    )
    rounding: float = 0.0  # how far published roundings may be from the order conditions

    @property
    def stages(self) -> int:
        return len(self.a)

    @property
    def rows(self) -> tuple[Row, ...]:
        """The weights of all stages, the interpolant's own included."""
        return (*self.a, *self.extra)

    @property
    def b(self) -> Row:
        """Weights of the method itself, with 0 for the last stage."""
        return (*self.a[-1], Fraction(0))

    @cached_property
    def c(self) -> Row:
        return tuple(sum(row, Fraction(0)) for row in self.rows)

    @property
    def error(self) -> Row:
        """Weights of the difference between the method and the embedded one."""
        return tuple(b - e for b, e in zip(self.b, self.embedded, strict=True))

    @property
    def second_error(self) -> Row:
        """Weights of the difference between the method and the coarser embedded one."""
        return tuple(b - e for b, e in zip(self.b, self.second, strict=True)) if self.second else ()
