"""The plots of the page: marks over two logarithmic axes, rows of ratios, rows of shares."""

from __future__ import annotations

import math
import textwrap
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

from .drawing import COLOURS, PAPER, SOFT, TEXT, Note, figure, inline_svg

WIDTH, ROW, FRAME = 6.4, 0.36, 0.9  # inches
LETTERS, LEGEND_LETTERS, ROW_LETTERS = 58, 62, 40  # of a line of text
LEGEND_ROW = 0.21
ACROSS, UP = 340.0, 280.0  # points that a scatter's axes are wide and high, nearly
SIDE, SIDEWAYS = 6.5, 5  # points of a mark, and so many to either side of where they all belong
ASIDE = 0.1  # decades that no mark is moved further than
LEAST_SPAN = 0.6  # decades of an axis: marks that differ by a hair should look so


@dataclass(frozen=True)
class Mark:
    """One mark of a scatter. `shape` is matplotlib's, `at` the JSON pointer of its data."""

    x: float
    y: float
    shape: str
    colour: int
    text: str
    at: str
    front: bool = False
    tie: bool = False
    chosen: bool = False


@dataclass(frozen=True)
class Key:
    """A row of a legend. `shape`: matplotlib's of a mark, or line, dashed, band, bar, ring, box."""

    shape: str
    colour: int | None  # None: the text's
    text: str


@dataclass(frozen=True)
class Scatter:
    """Marks, a staircase `front`, tie bands (low and high) and lines by colour.

    `base_ns`: what a ratio of 1 on the y axis is in ns, for an axis on the right.
    """

    name: str
    title: str
    marks: Sequence[Mark]
    legend: Sequence[Key]
    labels: tuple[str, str]
    fields: tuple[str, str]  # of a mark's data: what lies along x and y
    front: Sequence[tuple[float, float]] = ()
    bands: Sequence[tuple[float, float]] = ()
    lines: Sequence[tuple[int, Sequence[tuple[float, float]]]] = ()
    base_ns: float | None = None
    times: bool = False  # y is in ns


@dataclass(frozen=True)
class Row:
    """A named row: a ratio with its interval, or shares that add up to 1 at most."""

    label: str
    values: Sequence[float]
    notes: Sequence[Note]
    interval: tuple[float, float] | None = None
    colour: int = 0


@dataclass(frozen=True)
class Rows:
    name: str
    title: str
    label: str
    rows: Sequence[Row]
    legend: Sequence[Key]
    fields: tuple[str, ...]


@dataclass(frozen=True)
class Plot:
    """A plot as the page holds it. `fields`: of a mark's data, what it shows."""

    name: str
    title: str
    svg: str
    marks: int
    fields: tuple[str, ...] = field(default=())


def nanoseconds(value: float) -> str:
    """Text for a time: 20 ns, 5 us, 3 ms."""
    for unit, size in (("s", 1e9), ("ms", 1e6), ("\u00b5s", 1e3)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value:.3g} ns"


def short(value: float) -> str:
    """Text for a tick: 0.05, 20, 3e-7."""
    if 1e-3 <= value < 1e5:
        return f"{value:.6g}"
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")


def scatter(asked: Scatter) -> Plot:
    """A scatter as SVG; marks that would hide each other stand side by side."""
    across = limits([m.x for m in asked.marks])
    heights = [m.y for m in asked.marks] + [end for band in asked.bands for end in band]
    up = limits(heights)
    marks = side_by_side(asked.marks, across, _decades(across) / ACROSS, _decades(up) / UP)
    groups: dict[tuple[object, ...], list[Mark]] = defaultdict(list)
    for mark in sorted(marks, key=lambda m: (m.chosen, m.front, m.tie)):
        groups[mark.chosen, mark.front, mark.tie, mark.shape, mark.colour].append(mark)
    with _drawn(4.6, asked.legend) as (made, axes):
        _logarithmic(axes, "x", across, short)
        _logarithmic(axes, "y", up, nanoseconds if asked.times else short)
        axes.set_xlabel(textwrap.fill(asked.labels[0], LETTERS))
        axes.set_ylabel(asked.labels[1])
        for low, high in asked.bands:
            axes.axhspan(low, high, color=COLOURS[6], alpha=0.35, lw=1.5)
        if asked.front:
            x, y = zip(*asked.front, strict=True)
            axes.step(x, y, where="pre", color=TEXT, lw=1.2, ls=(0, (4, 2)))
        for colour, run in asked.lines:
            axes.plot(*zip(*run, strict=True), color=COLOURS[colour], lw=1.4)
        notes = {}
        for index, own in enumerate(groups.values()):
            notes[f"marks-{index}"] = [Note(m.text, m.at) for m in own]
            xs, ys = [m.x for m in own], [m.y for m in own]
            axes.plot(xs, ys, gid=f"marks-{index}", **_mark_style(own[0]))
        if asked.base_ns:
            _times_on_the_right(axes, asked.base_ns)
        svg = inline_svg(made, asked.title, notes)
    return Plot(asked.name, asked.title, svg, len(marks), asked.fields)


def ratio_rows(asked: Rows) -> Plot:
    """A ratio with its interval in each row, beside the line of 1."""
    ends = [v for row in asked.rows for v in (*row.values, *(row.interval or ()))]
    notes = {}
    with _rows(asked) as (made, axes):
        _logarithmic(axes, "x", limits([*ends, 1.0]), short)
        axes.axvline(1.0, color=SOFT, lw=1.2)
        for index, row in enumerate(asked.rows):
            notes[f"marks-{index}"] = row.notes
            style = {"color": COLOURS[row.colour], "zorder": 3}
            axes.plot(row.interval, [index, index], lw=2, **style)
            axes.plot(row.values, [index], "o", ms=6, gid=f"marks-{index}", **style)
        svg = inline_svg(made, asked.title, notes)
    return Plot(asked.name, asked.title, svg, len(asked.rows), asked.fields)


def share_rows(asked: Rows) -> Plot:
    """Bars of shares, one after the other in each row, in %."""
    notes, count = {}, 0
    with _rows(asked) as (made, axes):
        for index, row in enumerate(asked.rows):
            left = 0.0
            for n, (value, note) in enumerate(zip(row.values, row.notes, strict=True)):
                notes[f"marks-{count}"] = [note]
                style = {"color": COLOURS[n], "ec": PAPER, "lw": 0.6, "gid": f"marks-{count}"}
                axes.barh([index], [100 * value], 0.7, left=100 * left, **style)
                left, count = left + value, count + 1
        axes.set_xlim(0, 100)
        svg = inline_svg(made, asked.title, notes)
    return Plot(asked.name, asked.title, svg, count, asked.fields)


def limits(values: Iterable[float]) -> tuple[float, float]:
    """The ends of a logarithmic axis: a little room at either end."""
    positive = [v for v in values if v > 0 and math.isfinite(v)] or [1.0]
    least, most = math.log10(min(positive)), math.log10(max(positive))
    room = max(0.05 * (most - least), 0.5 * (LEAST_SPAN - (most - least)))
    return 10 ** (least - room), 10 ** (most + room)


def side_by_side(
    marks: Sequence[Mark], ends: tuple[float, float], across: float, up: float
) -> list[Mark]:
    """Marks moved sideways, a little, where they would hide each other; those of a front stay.

    `ends`: of the axis, which no mark is moved beyond; `across`, `up`: decades for a point.
    """
    room = [math.log10(end) / across / SIDE for end in ends]
    taken: dict[int, list[tuple[float, float]]] = defaultdict(list)
    steps = min(SIDEWAYS, int(ASIDE / (SIDE * across)))
    moves = sorted(range(-steps, steps + 1), key=abs)
    found = []
    for mark in sorted(marks, key=lambda m: (not m.front, not m.tie, m.y, m.x, m.text)):
        x, y = math.log10(mark.x) / across / SIDE, math.log10(mark.y) / up / SIDE
        near = [place for row in (-1, 0, 1) for place in taken[int(y // 1) + row]]
        inside = (n for n in moves if room[0] + 1 < x + n < room[1] - 1)
        free = (n for n in inside if all(abs(x + n - a) >= 1 or abs(y - b) >= 1 for a, b in near))
        moved = next(free, 0)
        taken[int(y // 1)].append((x + moved, y))
        found.append(replace(mark, x=mark.x * 10 ** (moved * SIDE * across)))
    return found


def _decades(ends: tuple[float, float]) -> float:
    return math.log10(ends[1] / ends[0])


@contextmanager
def _drawn(height: float, legend: Sequence[Key]) -> Iterator[tuple[Any, Any]]:
    """A figure with its legend below the axes."""
    texts = [textwrap.fill(key.text, LEGEND_LETTERS) for key in legend]
    lines = sum(text.count("\n") + 1 for text in texts)
    with figure(width=WIDTH, height=height + LEGEND_ROW * lines) as (made, axes):
        handles = [_handle(key) for key in legend]
        made.legend(handles, texts, loc="outside lower left", labelspacing=0.35)
        yield made, axes


@contextmanager
def _rows(asked: Rows) -> Iterator[tuple[Any, Any]]:
    """Named rows from the top down."""
    height = FRAME + ROW * len(asked.rows)
    with _drawn(height, asked.legend) as (made, axes):
        labels = [textwrap.fill(row.label, 30) for row in asked.rows]
        axes.set_yticks(range(len(labels)), labels)
        axes.set_ylim(len(labels) - 0.4, -0.6)
        axes.tick_params(axis="y", length=0)
        axes.grid(visible=False, axis="y")
        axes.set_xlabel(textwrap.fill(asked.label, ROW_LETTERS))
        yield made, axes


def _logarithmic(
    axes: Any, which: str, ends: tuple[float, float], text: Callable[[float], str]
) -> None:
    """Ticks at powers of ten, with 2 and 5 between them where they are few."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    wide = _decades(ends)
    digits = (1.0,) if wide > 2.4 else (1.0, 2.0, 5.0) if wide > 0.7 else tuple(range(1, 10))
    axes.set(**{f"{which}scale": "log", f"{which}lim": ends})
    axis = getattr(axes, f"{which}axis")
    axis.set_major_locator(LogLocator(subs=digits, numticks=9))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda value, _: text(value)))


def _times_on_the_right(axes: Any, base_ns: float) -> None:
    low, high = axes.get_ylim()
    right = axes.twinx()
    _logarithmic(right, "y", (low * base_ns, high * base_ns), nanoseconds)
    right.grid(visible=False)
    right.spines["right"].set_visible(True)
    right.set_ylabel("time for a collision")


def _mark_style(mark: Mark) -> dict[str, Any]:
    """Ties have a ring, the chosen a wider one about a larger mark."""
    colour = COLOURS[mark.colour]
    if mark.shape == "x":
        return {"marker": "x", "ms": SIDE, "ls": "none", "mec": colour, "mew": 2}
    ring, wide = (TEXT, 1.6) if mark.tie or mark.chosen else (PAPER, 0.5)
    size = {"*": 1.8, "D": 1.1}.get(mark.shape, 1.0) * (1.7 if mark.chosen else 1.0)
    return {
        "marker": mark.shape,
        "ms": SIDE * size,
        "ls": "none",
        "mfc": colour,
        "mec": ring,
        "mew": wide + mark.chosen,
        "alpha": 0.9,
    }


def _handle(key: Key) -> Any:
    """What stands before a row of a legend."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    colour = SOFT if key.colour is None else COLOURS[key.colour]
    if key.shape in ("bar", "band"):
        return Patch(color=colour, alpha=0.35 if key.shape == "band" else 1.0)
    if key.shape in ("line", "dashed"):
        dashes: Any = (0, (4, 2)) if key.shape == "dashed" else "-"
        return Line2D([], [], color=TEXT if key.colour is None else colour, ls=dashes)
    ringed = key.shape in ("ring", "box")
    mark = Mark(
        1, 1, "o" if ringed else key.shape, 0, "", "", tie=ringed, chosen=key.shape == "box"
    )
    style = _mark_style(mark)
    style |= {"mfc": PAPER if ringed else colour} | ({"mec": colour} if key.shape == "x" else {})
    return Line2D([], [], **style)
