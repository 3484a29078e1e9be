"""How far the models and pooltool's steps are from exact, over the speed and over the angle.

`picture(tool)` is what the report asks of this impact.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...evidence.timing.bench_tool import BenchTool
from ...evidence.verification.errors import Array
from ...report.drawing import COLOURS, figure, svg_of
from ...report.figures.models import Drawn
from .columns import COLUMNS

POOL = (0.028575, 0.170097, 0.2, 0.2, 0.85, 0.036576)  # pooltool's tables, both with its balls
SNOOKER = (0.026194, 0.14, 0.5, 0.5, 0.85, 0.028)
SPEEDS = np.geomspace(1e-3, 10.0, 161)  # m/s
ANGLES = np.linspace(0.0, 89.0, 357)  # degrees from straight into the cushion
SPEED = 1.0  # m/s, of the shots over the angle
SHOTS = {"straight roll": (0, 1), "roll at 45°": (45, 1), "stun at 45°": (45, 0)}
GRIDS = {"pooltool's classes, 1000 steps, 1e-3 Ns": 1000, "its solve(), 5000, 1e-4 Ns": 5000}
SAID = (3.0, 1.0, 0.1, 0.05, 0.01, 4e-3, 2e-3, 1e-3)  # m/s, whose rebound is told
TITLE = "Errors of pooltool's steps and of the paper as printed, against the model clamped"
_LINES: Mapping[int, Any] = {1000: "-", 5000: (0, (4, 2))}
_LEAST = 1e-5  # of the speed; below, a picture shows nothing


@dataclass(frozen=True)
class Gaps:
    """Errors of |v|, relative: over SPEEDS by shot and steps, over ANGLES by name."""

    over_speed: dict[tuple[str, int], Array]
    over_angle: dict[str, Array]
    rebound: Array  # of a straight roll at SAID, of its speed, by pooltool's classes
    exact: float  # the same at any speed


def shots(parameters: tuple[float, ...], speed: Array, degrees: Array, roll: float) -> Array:
    """Rows into a cushion along x, turned by no axis, so that rolling has its usual roundings."""
    normal = (0.6, 0.8)
    speed, degrees = np.broadcast_arrays(speed, degrees)
    along, into = speed * np.sin(np.radians(degrees)), speed * np.cos(np.radians(degrees))
    rows = np.zeros((len(speed), len(COLUMNS.case)))
    rows[:, : len(parameters)], rows[:, -2:] = parameters, normal
    level = [x * into + y * along for x, y in ((normal[0], normal[1]), (normal[1], -normal[0]))]
    rows[:, 6], rows[:, 7] = level
    rows[:, 9], rows[:, 10] = -roll * level[1] / parameters[0], roll * level[0] / parameters[0]
    return rows


def model_gaps(tool: BenchTool) -> Gaps:
    over_speed = {}
    for name, (degrees, roll) in SHOTS.items():
        rows = shots(POOL, SPEEDS, np.array(degrees), roll)
        exact = tool.expect(rows, "exact", "clamped")
        for steps in GRIDS.values():
            over_speed[name, steps] = _apart(
                tool.expect(rows, "euler", "pooltool", steps), exact, rows
            )
    over_angle = {}
    for name, parameters in (("pool", POOL), ("snooker", SNOOKER)):
        rows = shots(parameters, np.array(SPEED), ANGLES, 1)
        exact = tool.expect(rows, "exact", "clamped")
        stepped = tool.expect(rows, "euler", "pooltool", 1000)
        over_angle[f"{name}: pooltool's classes"] = _apart(stepped, exact, rows)
        if name == "snooker":
            printed = tool.expect(rows, "exact", "printed")
            over_angle[f"{name}: printed"] = _apart(printed, exact, rows)
    rows = shots(POOL, np.array(SAID), np.array(0.0), 1)
    told = tool.expect(rows, "euler", "pooltool", 1000)
    return Gaps(over_speed, over_angle, _speed(told) / SAID, float(_exact_rebound(tool, rows)))


def _speed(rows: Array) -> Array:
    return np.hypot(rows[:, 0], rows[:, 1])


def _exact_rebound(tool: BenchTool, rows: Array) -> float:
    return float((_speed(tool.expect(rows, "exact", "clamped")) / SAID)[0])


def _apart(found: Array, exact: Array, rows: Array) -> Array:
    """Of the velocities after, of the speed before."""
    apart: Array = _speed(found[:, :2] - exact[:, :2]) / np.hypot(rows[:, 6], rows[:, 7])
    return apart


def _shown(apart: Array) -> Array:
    return np.where(apart < _LEAST, np.nan, apart)


def draw(gaps: Gaps) -> str:
    """Two pictures side by side, as SVG."""
    with figure(columns=2, width=11.0, height=5.6) as (made, (left, right)):
        labels = {steps: grid for grid, steps in GRIDS.items()}
        for n, name in enumerate(SHOTS):
            for steps, line in _LINES.items():
                label = f"{name}, {labels[steps]}" if n == 0 or steps == 1000 else None
                apart = _shown(gaps.over_speed[name, steps])
                left.plot(SPEEDS, apart, color=COLOURS[n], ls=line, lw=1.6, label=label)
        left.set(xscale="log", yscale="log", xlim=(SPEEDS[0], SPEEDS[-1]))
        left.set_xlabel("speed, m/s")
        left.set_ylabel("error of the velocity, of the speed")
        left.set_title("Pool, over the speed")
        for n, (name, apart) in enumerate(gaps.over_angle.items()):
            right.plot(ANGLES, _shown(apart), color=COLOURS[n], lw=1.6, label=name)
        right.set(yscale="log", xlim=(ANGLES[0], 90))
        right.set_xlabel("angle of a natural roll from straight, degrees")
        right.set_title(f"Rolls of {SPEED:g} m/s, over the angle")
        for axes in (left, right):
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13))
        made.suptitle(TITLE)
        return svg_of(made, TITLE)


def picture(tool: BenchTool) -> Drawn:
    gaps = model_gaps(tool)
    lines = [
        f"a straight roll on pool comes back with {gaps.exact:.4f} of any speed; of pooltool's"
    ]
    lines += [f"  {v:g} m/s: {ratio:.3f}" for v, ratio in zip(SAID, gaps.rebound, strict=True)]
    for (name, steps), apart in gaps.over_speed.items():
        at = {v: float(np.interp(v, SPEEDS, apart)) for v in (0.01, 0.1, 1.0, 10.0)}
        told = ", ".join(f"{100 * error:.2g} % at {v:g} m/s" for v, error in at.items())
        lines.append(f"{name}, {steps} steps: {told}")
    for name, apart in gaps.over_angle.items():
        median, most = 100 * np.median(apart), 100 * apart.max()
        lines.append(f"{name}, over the angle: median {median:.2g} %, up to {most:.2g} %")
    return Drawn(draw(gaps), tuple(lines))
