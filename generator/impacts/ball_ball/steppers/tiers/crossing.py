"""The work of table friction after v_n = 0, where that lies within a step into sticking."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from .....lowering.lane_algebra import (
    Lines,
    Number,
    fma,
    given,
    larger,
    near_inverse,
    number,
    smaller,
    sqrt,
)
from .....tableaus.plain import PlainTableau
from ..exact.pressed import Pressed
from .whole import PRINTER, Text

LEAST_RISE = 1e-9  # of v_n in a step: it stands still where contact sticks
NEARLY = 0.999  # of a step: v_n = 0 is sought up to there first
_ROOT = sp.Rational(str(sp.N(sp.sqrt(sp.Rational(3, 5)) / 2, 30)))
GAUSS = (  # nodes and weights of Gauss's quadrature, exact for quintics
    (sp.Rational(1, 2) - _ROOT, sp.Rational(5, 18)),
    (sp.Rational(1, 2), sp.Rational(4, 9)),
    (sp.Rational(1, 2) + _ROOT, sp.Rational(5, 18)),
)


def work_after(tableau: PlainTableau, pressed: Pressed) -> Text:
    """`part`, the integral of v_n t_y from v_n = 0 to a step's end; v_n goes from v_a to v_e.

    From the rates t0, t1, ... and q0, q1, ... at the nodes: v_n and t_y are the polynomials through
    them. The step goes from y_a to y_e, as whose squares v_n rises but for the turning of c.
    """
    lines, nodes = Lines(PRINTER), range(len(tableau.nodes))
    rises = [
        lines.number(f"g{i}", fma(given(pressed.approach), number(f"t{i}"), 2 * number(f"q{i}")))
        for i in nodes
    ]
    t = _polynomial(lines, "t", tableau, [number(f"t{i}") for i in nodes])
    rise = _polynomial(lines, "g", tableau, rises)
    v = [number("v_a"), *(sp.Rational(1, k + 1) * c if k else c for k, c in enumerate(rise))]
    v = [lines.number(f"v{k}", c) for k, c in enumerate(v)]
    share = -number("v_a") * near_inverse(larger(number("v_e") - number("v_a"), LEAST_RISE))
    y_a, y_e = number("y_a"), number("y_e")
    square = fma(-smaller(share, 1), y_a * y_a - y_e * y_e, y_a * y_a)
    y = lines.number("y", sqrt(larger(square, 0)))
    near = smaller((y_a - y) * near_inverse(y_a - y_e), NEARLY)
    near = lines.number("near", larger(near, 0))
    lines.remark("One step of Newton's: the work hardly depends on where v_n is zero")
    off = _at(v, near) * near_inverse(larger(_at(rise, near), LEAST_RISE))
    start = lines.number("start", smaller(larger(near - off, 0), 1))
    left = lines.number("left", 1 - start)
    total: Number | None = None
    for i, (node, weight) in enumerate(GAUSS):
        x = lines.number(f"x{i}", fma(left, given(node), start))
        power = lines.number(f"power{i}", _at(v, x) * _at(t, x))
        total = given(weight) * power if total is None else fma(given(weight), power, total)
    lines.number("part", left * total)
    return lines.part()


def _polynomial(
    lines: Lines, name: str, tableau: PlainTableau, values: Sequence[Number]
) -> list[Number]:
    """Coefficients of the polynomial through values at the nodes."""
    nodes = [sp.Rational(*node.as_integer_ratio()) for node in tableau.nodes]
    inverse = sp.Matrix([[node**k for k in range(len(nodes))] for node in nodes]).inv()
    found = []
    for k in range(len(nodes)):
        total: Number | None = None
        for value, weight in zip(values, inverse.row(k), strict=True):
            if weight:
                total = given(weight) * value if total is None else fma(given(weight), value, total)
        found.append(lines.number(f"{name}_{k}", total))
    return found


def _at(coefficients: Sequence[Number], x: Number) -> Number:
    *lower, total = coefficients
    for coefficient in reversed(lower):
        total = fma(total, x, coefficient)
    return total
