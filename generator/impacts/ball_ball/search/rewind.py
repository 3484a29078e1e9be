"""Collisions run backward, many at once: from a chosen place inside one to where it began.

The reduced system of `mechanics`, by the Runge-Kutta method of order 8, the approach velocity being
the independent variable: every collision begins at v_n = -1. Steps are as long as the nearer of the
two vanishing slips allows, so that a passage at any distance is met again to some ten digits.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from ....evidence.verification.errors import Array
from ....tableaus.tableaus import TABLEAUS
from .. import symbols as s
from ..models import find_model
from ..reduced import reduced_system

C_X, C_Z, S_X, S_Y, WORK = range(5)  # columns of a place; v_n comes apart
_MOST_STEPS = 200
_TINY = 1e-300
_REACH = 0.75  # of the distance of a slip from zero, a step
_SLIPS = (s.C_X, s.C_Z, s.S2X, s.S2Y, s.V_N)
_IMPULSES = (s.DQ, s.D_X, s.D_Z, s.T2X, s.T2Y)


@cache
def _system(model: str) -> Array:
    """Slips' changes (rows) by impulses (columns), ball 2 pressed."""
    system = reduced_system(find_model(model).terms, 2)
    rows = [[float(system.coefficient(y, x)) for x in _IMPULSES] for y in _SLIPS]
    return np.array(rows)


@cache
def _stages() -> tuple[Array, ...]:
    return tuple(np.array([float(x) for x in row]) for row in TABLEAUS["dop853"].a)


def _rates(system: Array, at: Array, v_n: Array, u_b: Array, u_s: Array, out: Array) -> None:
    """d(c, s, work) / d v_n, in rows of five."""
    squares = at * at
    d = at[:2] * (-u_b / np.sqrt(squares[0] + squares[1] + _TINY))
    pull = u_s * -np.abs(d[1]) / np.sqrt(squares[2] + squares[3] + _TINY)
    changes = system[:, 1:3] @ d + system[:, 3:] @ (at[2:4] * pull) + system[:, :1]
    per_v = 1 / changes[4]
    np.multiply(changes[:4], per_v, out=out[:4])
    np.multiply(np.abs(v_n), per_v, out=out[WORK])


def _reach(place: Array, u_b: Array, u_s: Array) -> Array:
    """How far v_n may go in a step."""
    c = np.hypot(place[C_X], place[C_Z])
    slip = np.hypot(place[S_X], place[S_Y])
    reach: Array = 2 * _REACH * np.minimum(c / (8 * u_b + 1e-300), slip / (1 + 6 * u_b * (1 + u_s)))
    return reach


def rewind(model: str, place: Array, v_n: Array, to: Array, u_b: Array, u_s: Array) -> Array:
    """Places (rows of five, a column each collision) where v_n was `to`; NaN where not reached."""
    system, now = _system(model), np.array(v_n, dtype=np.float64)
    place = np.array(place, dtype=np.float64)
    for _ in range(_MOST_STEPS):
        todo = np.flatnonzero(now > to)
        if not len(todo):
            return place
        at, v, b, t = place[:, todo], now[todo], u_b[todo], u_s[todo]
        h = -np.minimum(v - to[todo], _reach(at, b, t) + 1e-15)
        ends = -h >= v - to[todo]
        place[:, todo] = _step(system, at, v, h, b, t)
        now[todo] = np.where(ends, to[todo], v + h)
    place[:, now > to] = np.nan
    return place


def _step(system: Array, at: Array, v: Array, h: Array, u_b: Array, u_s: Array) -> Array:
    rows = _stages()
    slopes = np.empty((len(rows) - 1, *at.shape))
    flat = slopes.reshape(len(slopes), -1)
    for k, row in enumerate(rows[:-1]):
        here = at + h * (row @ flat[:k]).reshape(at.shape) if k else at
        _rates(system, here, v + h * row.sum(), u_b, u_s, slopes[k])
    return at + h * (rows[-1] @ flat).reshape(at.shape)
