"""How time and error go with the number of fixed steps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..findings import GrowthPoint
from ..plots import Key, Mark, Plot, Scatter, nanoseconds, scatter

Series = tuple[str, str, int, list[tuple[int, int, float]]]  # what, shape, colour, places


def growth_fits(points: Sequence[GrowthPoint]) -> list[dict[str, Any]]:
    """What each step takes and what none of them does: least squares of relative deviations."""
    found = []
    for role in dict.fromkeys(point.role for point in points):
        own = [point for point in points if point.role == role]
        if len(own) > 1:
            steps, ns = np.array([[p.steps, p.ns] for p in own], dtype=float).T
            per_step, fixed = np.polyfit(steps, ns, 1, w=1 / ns)
            found.append({"role": role, "fixed": float(fixed), "per_step": float(per_step)})
    return found


def growth_plots(points: Sequence[GrowthPoint]) -> list[Plot]:
    """Time of all kernels; error of the last, with those of contacts that slip to the end apart."""
    if not points:
        return []
    roles = list(dict.fromkeys(point.role for point in points))
    looks = {role: ("*", 7) if n == 0 else ("o", n) for n, role in enumerate(roles)}
    times = [
        (role, *looks[role], [(n, p.steps, p.ns) for n, p in enumerate(points) if p.role == role])
        for role in roles
    ]
    own = [(n, p) for n, p in enumerate(points) if p.role == roles[-1]]
    errors = [
        ("all cases", "o", 5, [(n, p.steps, p.error) for n, p in own]),
        ("contacts that slip to the end", "o", 2, [(n, p.steps, p.slipping_error) for n, p in own]),
    ]
    title = f"Error falls with N while the contact slips ({roles[-1]})"
    label = "largest error, relative to |v1 \u2212 v2|"
    return [
        _plot("growth-time", "Time grows with N", "time for a collision", times),
        _plot("growth-error", title, label, errors),
    ]


def _plot(name: str, title: str, label: str, series: Sequence[Series]) -> Plot:
    marks, lines, timed = [], [], name == "growth-time"
    for what, shape, colour, places in series:
        shown = [(n, steps, value) for n, steps, value in places if value > 0]
        lines.append((colour, [(steps, value) for _, steps, value in shown]))
        for n, steps, value in shown:
            text = f"{what}, N = {steps}\n{nanoseconds(value) if timed else f'{value:.2e}'}"
            field = "ns" if timed else "error" if what == "all cases" else "slipping_error"
            marks.append(Mark(steps, value, shape, colour, text, f"/growth/{n}/{field}"))
    return scatter(
        Scatter(
            name,
            title,
            marks,
            [Key(shape, colour, what) for what, shape, colour, _ in series],
            ("N, steps of the scheme", label),
            ("steps", "value"),
            lines=lines,
            times=timed,
        )
    )
