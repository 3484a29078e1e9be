"""Coordinates of a search: nine numbers from 0 to 1 stand for a place inside an impact.

A chart says how: each number on a scale of its own, the place at the impact's start or at an event,
from which the impact is run backward. Events are a slip that vanishes (and with it the edge of
sticking, and of giving way), the table's contact that lifts, greatest compression, where both slips
may vanish at once, and the end.
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
from .envelope import MOST_ANGLES, Envelope
from .rewind import C_X, C_Z, S_X, WORK, Frictions, rewind

GENES = ("u_s", "u_w", "e_c", "nose", "slip", "turn", "other", "v_y", "v_x")
Edge = Literal["none", "sticks", "rolls", "lifts", "level"]
_EDGES: tuple[Edge, ...] = ("none", "sticks", "rolls", "lifts", "level")


@dataclass(frozen=True)
class Layout:
    """How a reduced state becomes a ball: what the slips leave open."""

    angle: float  # of the normal; 0: along y
    along: Scale | None  # speed along the cushion, over that of approach
    side: float  # its sign
    speed: float  # of approach, m/s


@dataclass(frozen=True)
class Chart:
    """What nine numbers mean. `nose`: the slip that has a size and a turn; else it is the table's.

    `still`: that slip is zero to the last bit. `edge`: what friction, or the turn, is nearly at.
    """

    u_s: Scale
    u_w: Scale
    e_c: Scale
    height: Scale
    nose: bool
    still: bool
    slip: Scale
    other: Scale
    turn: Literal["even", "level", "upright"]
    turned: float  # decades of the lesser component, where they are not even
    edge: Edge
    event: Event
    layout: Layout


def _layout(rng: np.random.Generator) -> Layout:
    usual, draw = rng.random() < 0.7, rng.random()
    along = None if draw < 0.4 else slip_scale(rng) if draw < 0.8 else Scale("log", 1.0, 5e3)
    return Layout(
        angle=0.0 if usual else float(rng.uniform(0, 2 * np.pi)),
        along=along,
        side=float(rng.choice([-1.0, 1.0])),
        speed=1.0 if usual else float(10 ** rng.uniform(-6, 1)),
    )


def draw_chart(rng: np.random.Generator, within: Envelope) -> Chart:
    """A chart at random; those in which errors are usually large come more often."""
    event: Event = rng.choice(["start", "anywhere", "compressed", "end"], p=[0.35, 0.35, 0.2, 0.1])
    vanishes = event != "start" or rng.random() < 0.4
    return Chart(
        u_s=parameter_scale(rng, within.u_s, 0.2),
        u_w=parameter_scale(rng, within.u_w, 0.2),
        e_c=parameter_scale(rng, within.e_c, 0.3),
        height=parameter_scale(rng, within.nose, 0.2),
        nose=bool(rng.random() < 0.6),
        still=bool(event == "start" and rng.random() < 0.2),
        slip=near_zero(rng) if vanishes else slip_scale(rng),
        other=near_zero(rng) if rng.random() < 0.4 else slip_scale(rng),
        turn=rng.choice(["even", "level", "upright"], p=[0.5, 0.15, 0.35]),
        turned=float(rng.choice([3.0, 6.0, 16.0])),
        edge=rng.choice(_EDGES, p=[0.5, 0.2, 0.1, 0.1, 0.1]),
        event=event,
        layout=_layout(rng),
    )


@dataclass(frozen=True)
class States:
    """Reduced states at the start of impacts, v_y = 1; rows C_X, C_Z, S_X."""

    slips: Array
    along: Array
    friction: Frictions
    e_c: Array


@dataclass(frozen=True)
class _Places:
    """Places inside impacts; `end`: how far from an event at the end, relative, else NaN."""

    slips: Array  # rows C_X, C_Z, S_X, WORK
    v_y: Array
    numbers: Array  # rows sine, u_s, u_w, e_c, end, along


def _turned(chart: Chart, x: Array) -> tuple[Array, Array]:
    """Direction of the slip that is drawn."""
    if chart.turn == "even":
        return np.cos(2 * np.pi * x), np.sin(2 * np.pi * x)
    small, side = signed(x, chart.turned), np.where(x < 0.5, -1.0, 1.0)
    large = side * np.sqrt(1 - small**2)
    return (large, np.abs(small)) if chart.turn == "level" else (np.abs(small), large)


def _places(chart: Chart, genes: Array, within: Envelope) -> _Places:
    """What rows of nine numbers stand for; any reals, cut off at 0 and 1."""
    x = np.clip(genes, 0.0, 1.0).T
    sine, e_c = chart.height(x[3]) - 1, chart.e_c(x[2])
    u_s, u_w = chart.u_s(x[0]), chart.u_w(x[1])
    near_s, near_w = 1 + signed(x[0], NEAR), 1 + signed(x[1], NEAR)
    slope = np.tan(np.arcsin(sine))
    if chart.edge == "level":
        u_w = slope * near_w
    size = np.zeros(len(genes)) if chart.still else chart.slip(x[4])
    one, two = _turned(chart, x[5])
    if chart.edge == "lifts":
        two = np.clip(-slope * near_w / np.maximum(u_w, 1e-12), -1.0, 1.0)
        one = np.sqrt(1 - two**2)
    other = np.where(x[6] < 0.5, -1.0, 1.0) * chart.other(np.abs(2 * x[6] - 1))
    v_y, end = approach_at(chart.event, e_c, x[7])
    slips = np.zeros((4, len(genes)))
    if chart.nose:
        slips[C_X], slips[C_Z], slips[S_X] = size * one, size * two, other
    else:
        slips[C_X], slips[S_X] = other, size * one
        slips[C_Z] = size * two - (1 + sine) * v_y
    friction = Frictions(within.model, sine, u_s, u_w)
    if chart.edge == "sticks":
        u_w = near_w * friction.to_stick(slips[S_X], slips[C_Z] + (1 + sine) * v_y)
    if chart.edge == "rolls":
        u_s = near_s * friction.to_roll(slips[C_X], slips[C_Z])
    along = chart.layout.along
    moving = np.zeros(len(genes)) if along is None else chart.layout.side * along(x[8])
    u_s, u_w = _admitted(sine, np.clip(u_s, *within.u_s), np.clip(u_w, *within.u_w), within)
    return _Places(slips, v_y, np.stack([sine, u_s, u_w, e_c, end, moving]))


def _admitted(sine: Array, u_s: Array, u_w: Array, within: Envelope) -> tuple[Array, Array]:
    """Frictions at which compression ends, and where `printed` has one answer; else NaN."""
    left = np.radians(MOST_ANGLES) - np.arcsin(sine) - np.arctan(u_s)
    most = np.tan(np.maximum(left, 0.0))
    if within.model == "printed":
        most = np.minimum(most, np.tan(np.arcsin(sine)))
    u_w = np.minimum(u_w, most)
    return u_s, np.where((left > 0) & (u_w >= within.u_w[0]), u_w, np.nan)


def states_of(
    charts: Sequence[Chart], asked: Sequence[Array], within: Envelope
) -> list[tuple[States, Layout]]:
    """Where impacts that meet the places begin; NaN where they do not. Run back as one."""
    made = [_places(chart, genes, within) for chart, genes in zip(charts, asked, strict=True)]
    sizes = np.cumsum([len(each.v_y) for each in made])[:-1]
    place = np.concatenate([each.slips for each in made], axis=-1)
    v_y = np.concatenate([each.v_y for each in made])
    sine, u_s, u_w, e_c, end, along = np.concatenate([each.numbers for each in made], axis=-1)
    friction = Frictions(within.model, sine, u_s, u_w)
    turned = np.maximum(v_y, 0.0)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        slips = rewind(friction, place, v_y, turned)
        back = slips[WORK].copy()  # of the restitution until the event
        slips = rewind(friction, slips, turned, np.ones_like(v_y))
    e_c = restitution_for(e_c, end, back, slips[WORK], within.e_c)
    split = np.split(np.arange(len(v_y)), sizes)
    return [
        (States(slips[:3, rows], along[rows], friction.of(rows), e_c[rows]), chart.layout)
        for rows, chart in zip(split, charts, strict=True)
    ]
