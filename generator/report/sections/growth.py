"""How time and error go with the number of fixed steps."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..findings import GrowthPoint
from ..known import Known
from ..layout import Block, Number, Paragraph, Piece, Plots, Section, number, records, text
from ..plots import Key, Mark, Plot, Scatter, nanoseconds, scatter

_ALL, _SLIPPING = 5, 2  # colours
_STEPS = "N, steps of the scheme"


def section(known: Known) -> Section:
    points = known.findings.growth if known.findings else ()
    rows, fits = [point.model_dump() for point in points], _fits(points)
    columns = [
        text("kernel", "role"),
        number("N", "count", "steps"),
        number("time, ns", "ns", "ns"),
        number("largest error", "error", "error"),
        number("largest error where contacts slip to the end", "error", "slipping_error"),
    ]
    blocks: list[Block] = [
        Plots([_times(points), _errors(points)] if points else []),
        records(("growth",), rows, columns),
    ]
    for n, fit in enumerate(fits):
        pieces: list[Piece] = [f"{fit['role']}: ", Number("mean", ("growth_fits", n, "per_step"))]
        pieces += [" ns for each N, and ", Number("mean", ("growth_fits", n, "fixed"))]
        pieces.append(" ns that do not grow with it (least squares of relative deviations).")
        blocks.append(Paragraph(pieces))
    data, missing = {"growth": rows, "growth_fits": fits}, known.unmeasured("growth")
    shown = blocks if rows else []
    return Section("growth", "Growth with N", "Growth with N", data, shown, missing)


def _fits(points: tuple[GrowthPoint, ...]) -> list[dict[str, Any]]:
    """What each step takes and what none of them does: least squares of relative deviations."""
    found = []
    for role in dict.fromkeys(point.role for point in points):
        own = [point for point in points if point.role == role]
        if len(own) > 1:
            steps, ns = np.array([[p.steps, p.ns] for p in own], dtype=float).T
            per_step, fixed = np.polyfit(steps, ns, 1, w=1 / ns)
            found.append({"role": role, "fixed": float(fixed), "per_step": float(per_step)})
    return found


def _times(points: tuple[GrowthPoint, ...]) -> Plot:
    roles = list(dict.fromkeys(point.role for point in points))
    looks = dict(zip(roles, (("*", 7), ("o", 1)), strict=False))
    marks = [
        Mark(
            p.steps,
            p.ns,
            *looks[p.role],
            f"{p.role}, N = {p.steps}\n{nanoseconds(p.ns)}",
            f"/growth/{n}",
        )
        for n, p in enumerate(points)
    ]
    lines = [
        (looks[role][1], [(p.steps, p.ns) for p in points if p.role == role]) for role in roles
    ]
    return scatter(
        Scatter(
            "growth-time",
            "Time grows with N",
            marks,
            [Key(*looks[role], role) for role in roles],
            (_STEPS, "time for a collision"),
            ("steps", "ns"),
            lines=lines,
            times=True,
        )
    )


def _errors(points: tuple[GrowthPoint, ...]) -> Plot:
    """Of the chosen kernel; those of contacts that slip to the end apart."""
    role = points[-1].role
    own = [(n, p) for n, p in enumerate(points) if p.role == role]
    marks, lines = [], []
    for key, colour, what in (
        ("error", _ALL, "all cases"),
        ("slipping_error", _SLIPPING, "contacts that slip to the end"),
    ):
        places = [(n, p.steps, getattr(p, key)) for n, p in own if getattr(p, key) > 0]
        lines.append((colour, [(steps, error) for _, steps, error in places]))
        marks += [
            Mark(
                steps,
                error,
                "o",
                colour,
                f"{role}, N = {steps}\n{what}: {error:.2e}",
                f"/growth/{n}/{key}",
            )
            for n, steps, error in places
        ]
    return scatter(
        Scatter(
            "growth-error",
            f"Error falls with N while the contact slips ({role})",
            marks,
            [
                Key("o", _ALL, "all cases"),
                Key("o", _SLIPPING, "contacts that slip to the end"),
            ],
            (_STEPS, "largest error, relative to |v1 \u2212 v2|"),
            ("steps", "error"),
            lines=lines,
        )
    )
