"""Explicit Runge-Kutta tableaus without an embedded method.

They are for steps whose error is bounded before they are made (an impact's steppers/tiers), which
need no estimate of it afterwards. Weights with roots of integers are rationals that are closer to
them than any number of a kernel.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import isqrt

from .tableau import Row

_DIGITS = 10**40
_ROOT_5 = Fraction(isqrt(5 * _DIGITS**2), _DIGITS)


@dataclass(frozen=True)
class PlainTableau:
    """A method of `order`: row i of `a` are the weights of stages 0..i-1, `b` those of the step."""

    name: str
    order: int
    a: tuple[Row, ...]
    b: Row
    source: str
    nodes: Row  # where in a step its rates are known best, the start first and the end last
    node_stages: tuple[int, ...]  # the last stages there

    @property
    def stages(self) -> int:
        return len(self.a)

    @property
    def c(self) -> Row:
        return tuple(sum(row, Fraction(0)) for row in self.a)


def _row(*weights: tuple[int, int, int]) -> Row:
    """Weights (p + q sqrt(5)) / r."""
    return tuple((p + q * _ROOT_5) / r for p, q, r in weights)


_NONE = (0, 0, 1)

BUTCHER_6 = PlainTableau(
    "butcher6",
    6,
    (
        (),
        _row((5, -1, 10)),
        _row((0, -1, 10), (5, 2, 10)),
        _row((-15, 7, 20), (-1, 1, 4), (15, -7, 10)),
        _row((5, -1, 60), _NONE, (1, 0, 6), (15, 7, 60)),
        _row((5, 1, 60), _NONE, (9, -5, 12), (1, 0, 6), (-5, 3, 10)),
        _row((1, 0, 6), _NONE, (-55, 25, 12), (-25, -7, 12), (5, -2, 1), (5, 1, 2)),
    ),
    _row((1, 0, 12), _NONE, _NONE, _NONE, (5, 0, 12), (5, 0, 12), (1, 0, 12)),
    "Butcher, Numerical Methods for Ordinary Differential Equations (2003), order 6 in 7 stages on "
    "the nodes of Lobatto's quadrature",
    nodes=_row(_NONE, (5, -1, 10), (5, 1, 10), (1, 0, 1)),
    node_stages=(0, 5, 4, 6),
)

_THIRD = Fraction(1, 3)

KUTTA_4 = PlainTableau(
    "kutta38",
    4,
    ((), (_THIRD,), (-_THIRD, Fraction(1)), (Fraction(1), Fraction(-1), Fraction(1))),
    (Fraction(1, 8), Fraction(3, 8), Fraction(3, 8), Fraction(1, 8)),
    "Kutta, Z. Math. Phys. 46 (1901) 435: order 4 in 4 stages, the 3/8 rule",
    nodes=(Fraction(0), _THIRD, 2 * _THIRD, Fraction(1)),
    node_stages=(0, 1, 2, 3),
)
