"""Geometry of plots whose rows have names: ratios with intervals, and stacked bars."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .plots import BOTTOM, TOP, WIDTH, LegendEntry, LogScale, Tick, short

ROW, BAR_LEFT, BAR_RIGHT = 26.0, 250.0, 20.0


@dataclass(frozen=True)
class RowMark:
    """A ratio with its interval on a row."""

    label: str
    y: float
    x: float
    low: float
    high: float
    colour: int
    title: str


@dataclass(frozen=True)
class Segment:
    x: float
    width: float
    colour: int
    title: str


@dataclass(frozen=True)
class BarRow:
    label: str
    y: float
    segments: tuple[Segment, ...]


@dataclass(frozen=True)
class Rows:
    """Named rows over one axis: ratios with intervals, or stacked bars."""

    name: str
    title: str
    x_label: str
    ticks: tuple[Tick, ...]
    marks: tuple[RowMark, ...]
    bars: tuple[BarRow, ...]
    one: float | None  # where the ratio is 1
    legend: tuple[LegendEntry, ...]
    height: float
    width: float = WIDTH
    left: float = BAR_LEFT
    right: float = BAR_RIGHT
    top: float = TOP
    bottom: float = BOTTOM


def ratio_rows(
    name: str,
    title: str,
    x_label: str,
    rows: Sequence[tuple[str, float, tuple[float, float], int, str]],
    legend: Sequence[LegendEntry],
) -> Rows:
    """Rows of (label, ratio, interval, colour, title)."""
    ends = [value for _, ratio, (low, high), _, _ in rows for value in (ratio, low, high)]
    across = LogScale([*ends, 1.0], BAR_LEFT, WIDTH - BAR_RIGHT)
    marks = tuple(
        RowMark(
            label, TOP + ROW * (n + 0.5), across(ratio), across(low), across(high), colour, text
        )
        for n, (label, ratio, (low, high), colour, text) in enumerate(rows)
    )
    height = TOP + ROW * len(rows) + BOTTOM
    ticks = across.ticks(short)
    return Rows(name, title, x_label, ticks, marks, (), across(1.0), tuple(legend), height)


def stacked_rows(
    name: str,
    title: str,
    x_label: str,
    rows: Sequence[tuple[str, Sequence[tuple[float, str]]]],
    legend: Sequence[LegendEntry],
) -> Rows:
    """Rows of (label, shares with a title each); the shares of a row add up to 1 at most."""
    span = WIDTH - BAR_RIGHT - BAR_LEFT
    bars = []
    for n, (label, shares) in enumerate(rows):
        x, segments = BAR_LEFT, []
        for colour, (share, text) in enumerate(shares):
            segments.append(Segment(round(x, 1), round(share * span, 1), colour, text))
            x += share * span
        bars.append(BarRow(label, TOP + ROW * (n + 0.5), tuple(segments)))
    ticks = tuple(Tick(BAR_LEFT + share * span / 100, f"{share} %") for share in range(0, 101, 20))
    height = TOP + ROW * len(rows) + BOTTOM
    return Rows(name, title, x_label, ticks, (), tuple(bars), None, tuple(legend), height)
