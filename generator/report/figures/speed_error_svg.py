"""The picture of speed against error: all schemes on the left, every tableau on the right."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ...tableaus.tableaus import TABLEAUS
from ..drawing import COLOURS, PAPER, TEXT, figure, svg_of
from .speed_error import Point, SpeedError, pareto_front

BLUE, RED, PINK = COLOURS[0], COLOURS[1], COLOURS[3]
# Shapes and fills of the tableaus, in their order: neighbours differ in both.
LOOKS = tuple(zip("ovsD^P<Xh", (*COLOURS[1:], COLOURS[0], TEXT), strict=False))
TITLE = "Time for a collision against its largest error"


def draw(shown: SpeedError) -> str:
    """The picture as SVG."""
    groups: dict[str, list[Point]] = {}
    for point in shown.points:
        groups.setdefault(point.group, []).append(point)
    family = [p for p in groups.get("family", []) if p.within_budget]
    base, exact = groups["baseline"][0], groups["exact"]
    with figure(columns=2, width=11.0, height=6.4) as (made, (left, right)):
        for axes in (left, right):
            axes.set(xscale="log", yscale="log")
            axes.invert_xaxis()
            axes.set_xlabel("largest error, relative to |v1 \u2212 v2| (smaller to the right)")
        left.set_ylabel("mean time for one collision, ns")
        left.set_title("Fixed steps and exact steppers")
        right.set_title("Every tableau, within its budget")
        _euler(left, groups["euler"])
        _line(left, exact, "s-", BLUE, "exact steppers, chosen for E = 1e-2 ... 1e-12")
        label = "paper-initial: the report's first C, N = 1000"
        left.plot(base.max_rel_error, base.ns, "*", ms=14, ls="none", color=TEXT, label=label)
        _names(left, exact)
        front = pareto_front([*family, *exact])
        x, y = [p.max_rel_error for p in front], [p.ns for p in front]
        style = {"color": TEXT, "lw": 1.0, "ls": (0, (4, 2)), "label": "Pareto front"}
        right.step(x, y, where="pre", **style)
        _tableaus(right, [*family, *exact])
        style = {"mfc": "none", "mec": BLUE, "ms": 13, "mew": 1.6, "ls": "none"}
        x, y = [p.max_rel_error for p in exact], [p.ns for p in exact]
        right.plot(x, y, "s", label="chosen for a budget E", **style)
        left.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13))
        right.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3)
        _ratios(right, base)
        made.suptitle(f"{TITLE}: {shown.model}, scene {shown.scene}; {shown.target}, one thread")
        return svg_of(made, TITLE)


def _line(axes: Any, points: Sequence[Point], look: str, colour: str, label: str) -> None:
    x, y = [p.max_rel_error for p in points], [p.ns for p in points]
    axes.plot(x, y, look, color=colour, ms=6.5, lw=1.3, label=label)


def _euler(axes: Any, points: Sequence[Point]) -> None:
    """All cases, and beside them those without contacts that stick."""
    _line(axes, points, "o-", RED, "fixed-step Euler, our fastest kernel, N = 10 ... 1e6")
    x, y = [p.max_slipping_error for p in points], [p.ns for p in points]
    style = {"color": PINK, "ms": 6, "lw": 1.3, "mfc": PAPER}
    axes.plot(x, y, "o--", label="the same, without contacts that stick", **style)
    for point in points:
        if str(point.steps)[0] == "1":
            note = {"xytext": (5, 6), "textcoords": "offset points", "fontsize": 10}
            text, place = f"N = {point.steps:,}", (point.max_slipping_error, point.ns)
            axes.annotate(text.replace(",", "\u202f"), place, **note)


def _names(axes: Any, points: Sequence[Point]) -> None:
    """The budgets, below the marks of some of the chosen."""
    for point in points:
        if round(-math.log10(point.budget or 1.0)) % 3 == 0:
            note = {"xytext": (0, -17), "textcoords": "offset points", "ha": "center"}
            text, place = f"E = {point.budget:.0e}", (point.max_rel_error, point.ns)
            axes.annotate(text.replace("e-0", "e-"), place, fontsize=10, color=BLUE, **note)
    axes.set_ylim(bottom=min(p.ns for p in points) / 2.5)


def _tableaus(axes: Any, points: Sequence[Point]) -> None:
    """One shape and colour a tableau."""
    for (name, tableau), (shape, colour) in zip(TABLEAUS.items(), LOOKS, strict=False):
        own = [p for p in points if p.stepper == name]
        if own:
            x, y = [p.max_rel_error for p in own], [p.ns for p in own]
            style = {"ms": 7, "ls": "none", "mew": 0.7, "mec": PAPER, "mfc": colour}
            axes.plot(x, y, shape, label=f"{name}, order {tableau.order}", **style)


def _ratios(axes: Any, base: Point) -> None:
    scale = base.ns / base.ratio
    ends = (lambda ns: ns / scale, lambda ratio: ratio * scale)
    axes.secondary_yaxis("right", functions=ends).set_ylabel("of paper-initial")
