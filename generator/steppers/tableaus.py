"""Explicit Runge-Kutta tableaus with embedded error estimates, in exact rationals.

A tableau is data: `expand` in lowering/exact_step.py turns it into statements. To add one: a
`Tableau` here; tests check its order conditions and its convergence.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

Row = tuple[Fraction, ...]


def _row(text: str) -> Row:
    return tuple(Fraction(word) for word in text.split())


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

    @property
    def stages(self) -> int:
        return len(self.a)

    @property
    def b(self) -> Row:
        """Weights of the method itself, with 0 for the last stage."""
        return (*self.a[-1], Fraction(0))

    @property
    def c(self) -> Row:
        return tuple(sum(row, Fraction(0)) for row in self.a)

    @property
    def error(self) -> Row:
        """Weights of the difference between the method and the embedded one."""
        return tuple(b - e for b, e in zip(self.b, self.embedded, strict=True))

    @property
    def slope_stage(self) -> int:
        """The last stage before the end of the step: it and the end give the second derivative."""
        return max(i for i, c in enumerate(self.c) if c < 1 and i > 0)

    @property
    def double_weights(self) -> Row:
        """b_i (1 - c_i): integrates the integral, for the work done in a step."""
        return tuple(b * (1 - c) for b, c in zip(self.b, self.c, strict=True))


BOGACKI_SHAMPINE_32 = Tableau(
    "bs32",
    3,
    2,
    (_row(""), _row("1/2"), _row("0 3/4"), _row("2/9 1/3 4/9")),
    _row("7/24 1/4 1/3 1/8"),
    "Bogacki, Shampine, Appl. Math. Lett. 2 (1989) 321",
)

DORMAND_PRINCE_54 = Tableau(
    "dp54",
    5,
    4,
    (
        _row(""),
        _row("1/5"),
        _row("3/40 9/40"),
        _row("44/45 -56/15 32/9"),
        _row("19372/6561 -25360/2187 64448/6561 -212/729"),
        _row("9017/3168 -355/33 46732/5247 49/176 -5103/18656"),
        _row("35/384 0 500/1113 125/192 -2187/6784 11/84"),
    ),
    _row("5179/57600 0 7571/16695 393/640 -92097/339200 187/2100 1/40"),
    "Dormand, Prince, J. Comput. Appl. Math. 6 (1980) 19",
)

TABLEAUS: dict[str, Tableau] = {t.name: t for t in (BOGACKI_SHAMPINE_32, DORMAND_PRINCE_54)}
