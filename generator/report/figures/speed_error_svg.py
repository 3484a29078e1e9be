"""The picture of speed against error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ...tableaus.tableaus import TABLEAUS
from .drawing import BLACK, BLUE, GREY, ORANGE, PINK, RED, figure, svg_of
from .speed_error import Measured, Point, pareto_front

MARKS = ("^", "v", "<", ">", "D", "P", "X", "h", "p", "d")
TITLE = "Time for a collision against its largest error"


def draw(measured: Measured) -> str:
    """The picture as SVG."""
    groups: dict[str, list[Point]] = {}
    for point in measured.points:
        groups.setdefault(point.group, []).append(point)
    with figure() as (made, axes):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.invert_xaxis()
        shown = [p for p in measured.points if p.group != "family" or p.within_budget]
        _front(axes, pareto_front(shown))
        _euler(axes, groups["euler"])
        _family(axes, [p for p in groups.get("family", []) if p.within_budget])
        _exact(axes, groups["exact"])
        base = groups["baseline"][0]
        label = "paper-initial: the report's first C, N = 1000"
        star = {"ms": 13, "ls": "none", "color": BLACK, "zorder": 6, "label": label}
        axes.plot(base.max_rel_error, base.ns, "*", **star)
        axes.set_xlabel("largest error of any case, relative to |v1 - v2| (smaller to the right)")
        axes.set_ylabel("mean time for one collision, ns")
        scale = base.ns / base.ratio
        right = axes.secondary_yaxis(
            "right", functions=(lambda ns: ns / scale, lambda ratio: ratio * scale)
        )
        right.set_ylabel("of paper-initial")
        axes.spines["right"].set_visible(False)
        axes.set_title(
            f"{TITLE}\n{measured.model}, scene {measured.scene}; {measured.target}, one thread",
            fontsize=10,
            loc="left",
        )
        axes.set_ylim(bottom=min(p.ns for p in measured.points) / 2)
        axes.legend(loc="upper right", fontsize=8)
        return svg_of(made, TITLE)


def _front(axes: Any, front: Sequence[Point]) -> None:
    """A staircase: right of and below it lies what no kernel reaches."""
    x = [p.max_rel_error for p in front]
    y = [p.ns for p in front]
    axes.step(x, y, where="post", color=BLACK, lw=1.0, ls=(0, (4, 2)), label="Pareto front")


def _euler(axes: Any, points: Sequence[Point]) -> None:
    x, y = [p.max_rel_error for p in points], [p.ns for p in points]
    label = "fixed-step Euler, our fastest kernel, N = 10 ... $10^6$"
    axes.plot(x, y, "o-", color=RED, ms=6, lw=1.2, label=label, zorder=4)
    easier = [p.max_slipping_error for p in points]
    style = {"color": PINK, "ms": 5.5, "lw": 1.2, "mfc": "white", "zorder": 4}
    axes.plot(easier, y, "o--", label="the same, without contacts that stick", **style)
    for point in points:
        steps = point.steps or 0
        exponent = len(str(steps)) - 1
        if str(steps)[0] == "1":
            text = f"N = {steps}" if exponent < 4 else f"$N = 10^{exponent}$"
            note = {"xytext": (7, 4), "textcoords": "offset points", "ha": "left"}
            axes.annotate(
                text, (point.max_slipping_error, point.ns), fontsize=8, color=BLACK, **note
            )


def _exact(axes: Any, points: Sequence[Point]) -> None:
    x, y = [p.max_rel_error for p in points], [p.ns for p in points]
    label = "exact steppers, chosen for E = $10^{-2}$ ... $10^{-12}$"
    axes.plot(x, y, "s-", color=BLUE, ms=6.5, lw=1.2, label=label, zorder=5)
    for point in points:
        exponent = round(-math.log10(point.budget or 1.0))
        if exponent % 3 == 0:
            note = {"xytext": (0, -17), "textcoords": "offset points", "ha": "center"}
            text, place = f"$E = 10^{{-{exponent}}}$", (point.max_rel_error, point.ns)
            axes.annotate(text, place, fontsize=8, color=BLUE, **note)


def _family(axes: Any, points: Sequence[Point]) -> None:
    """Small marks, one shape a tableau."""
    for index, (name, tableau) in enumerate(TABLEAUS.items()):
        own = [p for p in points if p.stepper == name]
        if own:
            fill = ORANGE if index % 2 else "white"
            style = {"ms": 4, "ls": "none", "mew": 0.8, "mec": GREY, "mfc": fill, "zorder": 3}
            x, y = [p.max_rel_error for p in own], [p.ns for p in own]
            label = f"{name}, order {tableau.order}"
            axes.plot(x, y, MARKS[index % len(MARKS)], label=label, **style)
