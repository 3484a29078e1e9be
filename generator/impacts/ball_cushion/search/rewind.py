"""Impacts run backward: from a place inside to where they begin.

The independent variable is v_y, which always falls; a place is the three slips c_x, c_z and s_x,
and the work of the normal impulse. A contact that slips drives its slip to zero, so backward slips
grow, and no event ends a run but its start. Far less exact than an oracle, and fast: a search wants
places near to an event, and corrects what is left.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ....evidence.verification.errors import Array
from ....tableaus.tableaus import TABLEAUS
from .. import symbols as s
from ..contact import table_force, velocity_rates, work_rate
from ..models import find_model
from ..reduced import slip_rates, stuck_cushion, stuck_table

C_X, C_Z, S_X, WORK = range(4)  # rows of a place; v_y comes apart
_MOST_STEPS = 200
_TINY = 1e-300
_REACH = 0.5  # of a slip's distance from zero, a step
_FRICTION = (s.D_X, s.D_Z, s.T_X, s.T_Y)
Function = Callable[..., Any]


@cache
def _rates() -> Function:
    """Of c_x, c_z, s_x and v_y per q, of sin theta, cos theta and friction."""
    slips = slip_rates()
    forms = [slips[s.C_X], slips[s.C_Z], slips[s.S_X], velocity_rates()[s.V_Y]]
    made: Function = sp.lambdify((s.SIN, s.COS, *_FRICTION), forms, "numpy")
    return made


@cache
def _form(which: str) -> Function:
    nose, names = stuck_cushion(), (s.SIN, s.COS)
    asked = {
        "force": ((*names, s.D_Z), table_force()),
        "work": ((*names, s.V_Y), work_rate()),
        "sticking": ((*names, s.U_S, s.ES_X, s.ES_Y), [*nose.friction.values(), nose.force]),
        "rolling": ((*names, s.D_X, s.D_Z), list(stuck_table().values())),
    }
    made: Function = sp.lambdify(*asked[which], "numpy")
    return made


@cache
def _stages() -> tuple[Array, ...]:
    return tuple(np.array([float(x) for x in row]) for row in TABLEAUS["dop853"].a)


class Frictions:
    """Parameters of many impacts at once, and what they make of slips under a contact model."""

    def __init__(self, model: str, sine: Array, u_s: Array, u_w: Array) -> None:
        self.clamped = find_model(model).terms.clamped
        self.sine, self.cosine = sine, np.sqrt(1 - sine * sine)
        self.u_s, self.u_w = u_s, u_w
        self._model = model

    def of(self, rows: NDArray[np.intp]) -> Frictions:
        return Frictions(self._model, self.sine[rows], self.u_s[rows], self.u_w[rows])

    def force(self, d_z: Array) -> Array:
        """N, for a unit of q."""
        force: Array = _form("force")(self.sine, self.cosine, d_z) + 0 * d_z
        return np.maximum(force, 0.0) if self.clamped else force

    def rates(self, at: Array, v_y: Array) -> Array:
        """Of c_x, c_z, s_x, v_y and work per q, in rows."""
        pull = -self.u_w / np.sqrt(at[C_X] ** 2 + at[C_Z] ** 2 + _TINY)
        d_x, d_z = at[C_X] * pull, at[C_Z] * pull
        s_y = at[C_Z] + (1 + self.sine) * v_y
        pull = -self.u_s * self.force(d_z) / np.sqrt(at[S_X] ** 2 + s_y**2 + _TINY)
        changes = _rates()(self.sine, self.cosine, d_x, d_z, at[S_X] * pull, s_y * pull)
        work = np.abs(_form("work")(self.sine, self.cosine, v_y))
        return np.stack([*np.broadcast_arrays(*changes, work)])

    def to_stick(self, s_x: Array, s_y: Array) -> Array:
        """The friction of the cushion at which the nose begins to stick, slips being so."""
        slip = np.hypot(s_x, s_y) + _TINY
        given = self.sine, self.cosine, self.u_s, s_x / slip, s_y / slip
        d_x, d_z, _ = np.broadcast_arrays(*_form("sticking")(*given))
        needed: Array = np.hypot(d_x, d_z)
        return needed

    def to_roll(self, c_x: Array, c_z: Array) -> Array:
        """The friction of the table at which its contact begins to stick, slips being so."""
        pull = -self.u_w / (np.hypot(c_x, c_z) + _TINY)
        d_x, d_z = c_x * pull, c_z * pull
        t_x, t_y = np.broadcast_arrays(*_form("rolling")(self.sine, self.cosine, d_x, d_z))
        needed: Array = np.hypot(t_x, t_y) / np.maximum(self.force(d_z), 1e-12)
        return needed


def rewind(friction: Frictions, place: Array, v_y: Array, to: Array) -> Array:
    """Places where v_y was `to`; NaN where that was not reached."""
    now, place = np.array(v_y, dtype=np.float64), np.array(place, dtype=np.float64)
    for _ in range(_MOST_STEPS):
        todo = np.flatnonzero(now < to)
        if not len(todo):
            return place
        own, at, v = friction.of(todo), place[:, todo], now[todo]
        h = np.minimum(to[todo] - v, _reach(own, at, v) + 1e-15)
        ends = h >= to[todo] - v
        place[:, todo] = _step(own, at, v, h)
        now[todo] = np.where(ends, to[todo], v + h)
    place[:, now < to] = np.nan
    return place


def _reach(friction: Frictions, at: Array, v_y: Array) -> Array:
    """How far v_y may go in a step: a share of what a slip, and its friction, change in it."""
    rates = np.abs(friction.rates(at, v_y))
    s_y = at[C_Z] + (1 + friction.sine) * v_y
    nose, table = np.hypot(at[C_X], at[C_Z]), np.hypot(at[S_X], s_y)
    turns = 4 * (friction.u_w + friction.u_s * friction.force(-friction.u_w)) + 1e-300
    per_q = np.minimum(nose, table) / (np.maximum(rates[:3].max(axis=0), turns))
    reach: Array = _REACH * rates[3] * per_q
    return reach


def _step(friction: Frictions, at: Array, v: Array, h: Array) -> Array:
    rows = _stages()
    slopes = np.empty((len(rows) - 1, *at.shape))
    flat = slopes.reshape(len(slopes), -1)
    for k, row in enumerate(rows[:-1]):
        here = at + h * (row @ flat[:k]).reshape(at.shape) if k else at
        rates = friction.rates(here, v + h * row.sum())
        slopes[k] = np.concatenate([rates[:3], rates[4:]]) / rates[3]
    return at + h * (rows[-1] @ flat).reshape(at.shape)
