"""Geometry of the page's plots: what is drawn where. templates/report/plot.j2 draws it.

Plain SVG in the page's own colours, so that it follows light and dark pages, and a mark for each
variant that names it when pointed at: pictures of a plotting library do neither.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from matplotlib.ticker import LogLocator

WIDTH, HEIGHT = 760.0, 430.0
LEFT, RIGHT, TOP, BOTTOM = 74.0, 74.0, 14.0, 54.0
SIDE, SIDEWAYS = 9.0, 5  # width of a mark, and so many to either side of where they all belong
ASIDE = 0.1  # decades that no mark is moved further than
LEAST_SPAN = 0.6  # decades of an axis: marks that differ by a hair should look so

SHAPES = ("circle", "square", "triangle", "diamond", "star")
COLOURS = 8  # classes c0 to c7


@dataclass(frozen=True)
class Point:
    """A mark: where it stands in the units of its axes or, in a Plot, in those of the drawing."""

    x: float
    y: float
    shape: str
    colour: int
    title: str
    front: bool = False
    tie: bool = False


@dataclass(frozen=True)
class Tick:
    at: float
    text: str


@dataclass(frozen=True)
class Line:
    points: str
    colour: int | None  # None: the text's colour
    dashed: bool = False


@dataclass(frozen=True)
class Band:
    top: float
    height: float
    text: str


@dataclass(frozen=True)
class LegendEntry:
    shape: str  # of SHAPES, or "line", "dashed", "band", "bar", "ring", "cross"
    colour: int | None
    text: str


@dataclass(frozen=True)
class Plot:
    """A plot of marks over two logarithmic axes."""

    name: str
    title: str
    x_label: str
    y_label: str
    right_label: str
    x_ticks: tuple[Tick, ...]
    y_ticks: tuple[Tick, ...]
    right_ticks: tuple[Tick, ...]
    marks: tuple[Point, ...]
    lines: tuple[Line, ...]
    bands: tuple[Band, ...]
    legend: tuple[LegendEntry, ...]
    width: float = WIDTH
    height: float = HEIGHT
    left: float = LEFT
    right: float = RIGHT
    top: float = TOP
    bottom: float = BOTTOM


class LogScale:
    """From values to places; a little room at either end."""

    def __init__(self, values: Iterable[float], low: float, high: float) -> None:
        positive = [v for v in values if v > 0 and math.isfinite(v)] or [1.0]
        least, most = math.log10(min(positive)), math.log10(max(positive))
        room = max(0.05 * (most - least), 0.5 * (LEAST_SPAN - (most - least)))
        self.least, self.most = least - room, most + room
        self.low, self.high = low, high

    def __call__(self, value: float) -> float:
        share = (math.log10(value) - self.least) / (self.most - self.least)
        return round(self.low + share * (self.high - self.low), 1)

    def ticks(self, text: Callable[[float], str]) -> tuple[Tick, ...]:
        """Powers of ten, with 2 and 5 between them where they are few."""
        wide = self.most - self.least
        digits = (1.0,) if wide > 2.4 else (1.0, 2.0, 5.0) if wide > 0.7 else tuple(range(1, 10))
        found = LogLocator(subs=digits, numticks=12).tick_values(10**self.least, 10**self.most)
        inside = [v for v in found if self.least <= math.log10(v) <= self.most]
        return tuple(Tick(self(v), text(v)) for v in inside)


def short(value: float) -> str:
    """Text for a tick: 0.05, 20, 3e-07."""
    if 1e-3 <= value < 1e5:
        return f"{value:.6g}"
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")


def nanoseconds(value: float) -> str:
    """Text for a tick: 20 ns, 5 us, 3 ms."""
    for unit, size in (("s", 1e9), ("ms", 1e6), ("\u00b5s", 1e3)):
        if value >= size:
            return f"{value / size:g} {unit}"
    return f"{value:g} ns"


def scatter(
    name: str,
    title: str,
    points: Sequence[Point],
    legend: Sequence[LegendEntry],
    x_label: str,
    y_label: str,
    y_text: Callable[[float], str] = short,
    front: Sequence[tuple[float, float]] = (),
    bands: Sequence[tuple[float, float, str]] = (),
    series: Sequence[tuple[int, Sequence[tuple[float, float]]]] = (),
    base_ns: float | None = None,
) -> Plot:
    """Marks, a staircase `front`, tie bands (low, high, text) and lines by colour.

    `base_ns`: what a ratio of 1 on the y axis is in ns, for an axis on the right.
    """
    across = LogScale([p.x for p in points], LEFT, WIDTH - RIGHT)
    heights = [p.y for p in points] + [y for low, high, _ in bands for y in (low, high)]
    up = LogScale(heights, HEIGHT - BOTTOM, TOP)
    right: tuple[Tick, ...] = ()
    if base_ns:
        scale = LogScale([], HEIGHT - BOTTOM, TOP)
        scale.least, scale.most = (end + math.log10(base_ns) for end in (up.least, up.most))
        right = scale.ticks(nanoseconds)
    placed_marks = [replace(p, x=across(p.x), y=up(p.y)) for p in points]
    decade = (across.high - across.low) / (across.most - across.least)
    steps = min(SIDEWAYS, int(ASIDE * decade / SIDE))
    marks = tuple(sorted(_side_by_side(placed_marks, steps), key=lambda p: (p.front, p.tie)))
    lines = [Line(_staircase([(across(x), up(y)) for x, y in front]), None, True)] if front else []
    lines += [Line(_path([(across(x), up(y)) for x, y in run]), c) for c, run in series]
    placed = tuple(_band(up, low, high, text) for low, high, text in bands)
    return Plot(
        name,
        title,
        x_label,
        y_label,
        "time for a collision" if right else "",
        across.ticks(short),
        up.ticks(y_text),
        right,
        marks,
        tuple(lines),
        placed,
        tuple(legend),
    )


def _side_by_side(marks: Sequence[Point], steps: int) -> list[Point]:
    """Marks moved sideways, a little, where they would hide each other; those of a front stay.

    `steps`: widths of a mark that they may be moved to either side.
    """
    taken: dict[int, list[tuple[float, float]]] = defaultdict(list)
    found = []
    for mark in sorted(marks, key=lambda p: (not p.front, not p.tie, p.y, p.x, p.title)):
        row = int(mark.y // SIDE)
        near = [place for other in (row - 1, row, row + 1) for place in taken[other]]
        x = next((x for x in _beside(mark.x, steps) if not _hides(x, mark.y, near)), mark.x)
        taken[row].append((x, mark.y))
        found.append(replace(mark, x=round(x, 1)))
    return found


def _beside(x: float, steps: int) -> list[float]:
    """Places to try, the nearest first."""
    numbers = sorted(range(-steps, steps + 1), key=abs)
    return [x + SIDE * n for n in numbers if LEFT < x + SIDE * n < WIDTH - RIGHT]


def _hides(x: float, y: float, near: Iterable[tuple[float, float]]) -> bool:
    return any(abs(x - a) < SIDE and abs(y - b) < SIDE for a, b in near)


def _band(up: LogScale, low: float, high: float, text: str) -> Band:
    top, bottom = up(high), up(low)
    height = max(bottom - top, 2.0)  # a band of 1 % would not be seen on a long axis
    return Band((top + bottom - height) / 2, height, text)


def _path(places: Sequence[tuple[float, float]]) -> str:
    return " ".join(f"{x:g},{y:g}" for x, y in places)


def _staircase(places: Sequence[tuple[float, float]]) -> str:
    """From the fastest to the most exact: left and down of it lies what no kernel reaches."""
    ordered = sorted(places, key=lambda place: -place[1])
    corners = []
    for index, (x, y) in enumerate(ordered):
        if index:
            corners.append((ordered[index - 1][0], y))
        corners.append((x, y))
    return _path(corners)
