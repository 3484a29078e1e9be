"""Coordinates of a search: eight numbers from 0 to 1 stand for a place inside a collision.

A chart says how: each number on a scale of its own, the place at the collision's start or at an
event, from which the collision is run backward. Many charts make one search: what is a spike in
one of them is a wide hill in another.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ....evidence.challenge.scales import (
    NEAR,
    Event,
    Scale,
    approach_at,
    near_zero,
    parameter_scale,
    restitution_for,
    signed,
    slip_scale,
)
from ....evidence.verification.errors import Array
from .envelope import Envelope
from .rewind import C_X, C_Z, S_X, S_Y, WORK, rewind

GENES = ("u_b", "u_s", "e_b", "c", "turn", "s", "angle", "v_n")
# Of e_b, where the kernels' method changes: `kLittleBounce` and the tiers' least e_b.
THRESHOLDS = (0.001, 0.4)


@dataclass(frozen=True)
class Layout:
    """How a reduced state becomes two balls: what the slips leave open."""

    pressed_first: bool  # ball 1 is pressed, not ball 2
    angle: float  # of the line of centres
    moving: float  # share of the level contact slip that is speed, not spin
    spun: bool  # the pressed ball's slip along the line of centres is spin alone
    speed: float  # of approach, m/s


@dataclass(frozen=True)
class Chart:
    """What eight numbers mean."""

    u_b: Scale
    u_s: Scale
    e_b: Scale
    c: Scale
    s: Scale
    turn: Literal["even", "level", "vertical"]
    turned: float  # decades of the lesser component of c, where they are not even
    event: Event
    layout: Layout


def _restitution(rng: np.random.Generator, bounds: tuple[float, float]) -> Scale:
    low, high = bounds
    inside = [e for e in THRESHOLDS if low < e < high]
    if inside and rng.random() < 0.15:
        return Scale("about", low, high, about=float(rng.choice(inside)), decades=NEAR)
    return parameter_scale(rng, bounds, 0.3)


def _layout(rng: np.random.Generator) -> Layout:
    usual = rng.random() < 0.7
    return Layout(
        pressed_first=bool(rng.random() < 0.3),
        angle=0.0 if usual else float(rng.uniform(0, 2 * np.pi)),
        moving=0.0 if rng.random() < 0.7 else float(rng.uniform(0, 1)),
        spun=bool(rng.random() < 0.3),
        speed=1.0 if usual else float(10 ** rng.uniform(-6, 1.7)),
    )


def draw_chart(rng: np.random.Generator, within: Envelope) -> Chart:
    """A chart at random; those in which errors are usually large come more often."""
    event: Event = rng.choice(["start", "anywhere", "compressed", "end"], p=[0.5, 0.2, 0.1, 0.2])
    vanishing = rng.random() < 0.6  # at an event: the table slip, else the contact slip
    near = near_zero(rng)
    if event == "start":
        wide = rng.random() < 0.2
        c = Scale("log", 1e-10, 1e4) if wide else slip_scale(rng)
        s = near if rng.random() < 0.3 else slip_scale(rng)
    elif vanishing:
        c, s = slip_scale(rng), near
    else:
        c, s = near, slip_scale(rng)
    return Chart(
        u_b=parameter_scale(rng, within.u_b, 0.35),
        u_s=parameter_scale(rng, within.u_s, 0.35),
        e_b=_restitution(rng, within.e_b),
        c=c,
        s=s,
        turn=rng.choice(["even", "level", "vertical"], p=[0.55, 0.3, 0.15]),
        turned=float(rng.choice([3.0, 6.0, 16.0])),
        event=event,
        layout=_layout(rng),
    )


@dataclass(frozen=True)
class States:
    """Reduced states at the start of collisions, v_n = -1; rows for C_X, C_Z, S_X, S_Y."""

    slips: Array
    u_b: Array
    u_s: Array
    e_b: Array


@dataclass(frozen=True)
class Places:
    """Places inside collisions; `end`: how far from an event at the end, relative, else NaN."""

    slips: Array  # rows C_X, C_Z, S_X, S_Y, WORK
    v_n: Array
    u_b: Array
    u_s: Array
    e_b: Array
    end: Array


def _turned(chart: Chart, x: Array) -> tuple[Array, Array]:
    """Direction of the contact slip; its second component is negative: ball 2 is pressed."""
    if chart.turn == "even":
        return np.cos(np.pi * x), -np.sin(np.pi * x)
    small = signed(x, chart.turned)
    if chart.turn == "level":
        return np.where(x < 0.5, -1.0, 1.0) * np.sqrt(1 - small**2), -np.abs(small)
    return small, -np.sqrt(1 - small**2)


def places_of(chart: Chart, genes: Array) -> Places:
    """What rows of eight numbers stand for; any reals, cut off at 0 and 1."""
    x = np.clip(genes, 0.0, 1.0).T
    u_b, u_s, e_b = chart.u_b(x[0]), chart.u_s(x[1]), chart.e_b(x[2])
    size, s_size = chart.c(x[3]), chart.s(x[5])
    c_x, c_z = _turned(chart, x[4])
    angle = 2 * np.pi * genes[:, 6]
    slips = np.zeros((5, len(genes)))
    slips[C_X], slips[C_Z] = size * c_x, size * c_z
    slips[S_X], slips[S_Y] = s_size * np.cos(angle), s_size * np.sin(angle)
    approach, end = approach_at(chart.event, e_b, x[7])
    return Places(slips, -approach, u_b, u_s, e_b, end)


def states_of(places: Sequence[Places], within: Envelope) -> list[States]:
    """Where collisions that meet the places begin; NaN where they do not. Run back as one."""
    sizes = np.cumsum([len(p.v_n) for p in places])[:-1]
    all_of = Places(
        *(np.concatenate(parts, axis=-1) for parts in zip(*map(_parts, places), strict=True))
    )
    _, v_n, u_b, u_s, e_b, end = _parts(all_of)
    least = np.minimum(v_n, 0.0)
    slips = rewind(within.model, all_of.slips, v_n, least, u_b, u_s)
    back = slips[WORK].copy()  # negative: of the restitution until the event
    slips = rewind(within.model, slips, least, np.full_like(v_n, -1.0), u_b, u_s)
    e_b = restitution_for(e_b, end, back, slips[WORK], within.e_b)
    tables = (slips[:4], u_b, u_s, e_b)
    split = [np.split(table, sizes, axis=-1) for table in tables]
    return [States(*parts) for parts in zip(*split, strict=True)]


def _parts(places: Places) -> tuple[Array, ...]:
    return places.slips, places.v_n, places.u_b, places.u_s, places.e_b, places.end
