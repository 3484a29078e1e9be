"""How far a step may be off where the table slip passes near zero: bounds from the derivation.

On a straight path s/|s| is analytic but at the two points where s^2 = 0. Let rho be the size of the
ellipse through them with foci at the ends of a step (Bernstein's): rho + 1/rho is twice the sum of
|s| at both ends over the length of the path. What a tableau's weights miss of the integral of s/|s|
depends on rho and on where on the ellipse the points lie; its largest is a number for each tableau
and rho. docs/step-control.md has the derivation.
"""

from __future__ import annotations

import cmath
import math
from functools import cache

from .....tableaus.tableau import Tableau

_SIZES = (1.05, 1.1, 1.2, 1.35, 1.5, 1.75, 2, 2.5, 3, 4, 5, 7, 10, 15, 20)
_ANGLES = 24


def steepness(rho: float) -> float:
    """1 / P: what a kernel has of an ellipse, from three lengths; 1 where s passes zero itself.

    P = rho^2 + 1/rho^2 - 1 = 4 ((|s0| + |s1|) / |s1 - s0|)^2 - 3.
    """
    return 1 / (rho * rho + 1 / (rho * rho) - 1)


def _into_sticking(share: float) -> tuple[float, float]:
    """The slip falls as (1 - t)^2, and so does the rest of the path; friction is its rate."""
    left = 1 - share
    return 1 - left * left, 2 * left


def _missed(tableau: Tableau, closest: complex) -> float:
    """The error of the integral of s/|s| on a path of length 1 past zero at `closest`."""
    at, miss = closest.real, max(abs(closest.imag), 1e-9)

    def whole(x: float) -> tuple[float, float]:
        return math.hypot(x - at, miss), miss * math.asinh((x - at) / miss)

    along, across = (high - low for high, low in zip(whole(1.0), whole(0.0), strict=True))
    for weight, share in zip(tableau.b, tableau.c, strict=False):
        if weight:
            x, pace = _into_sticking(float(share))
            size = math.hypot(x - at, miss)
            along -= float(weight) * pace * (x - at) / size
            across -= float(weight) * pace * miss / size
    return max(abs(along), abs(across))


def _largest(tableau: Tableau, rho: float) -> float:
    angles = [math.pi * (i + 0.5) / _ANGLES for i in range(_ANGLES)]
    points = [(rho * cmath.exp(1j * a) + cmath.exp(-1j * a) / rho + 2) / 4 for a in angles]
    return max(_missed(tableau, point) for point in points)


@cache
def sticking_bound(tableau: Tableau) -> tuple[float, int]:
    """The step into sticking misses at most factor / P^power of the friction left on the table."""
    power = max(1, (tableau.order + 1) // 2 - 1)
    return max(_largest(tableau, rho) / steepness(rho) ** power for rho in _SIZES), power


def largest_weight(tableau: Tableau) -> float:
    """The most that a step can miss of the friction on the table, whichever way it turns."""
    return 1 + float(sum(map(abs, tableau.b)))
