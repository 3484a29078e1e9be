"""How far the contact models differ: the same shots through the exact solution of each.

`picture(tool)` is what the report asks of this impact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...evidence.timing.bench_tool import BenchTool
from ...evidence.verification.errors import Array
from ...report.drawing import COLOURS, figure, svg_of
from ...report.figures.models import Drawn

R, M, U_S, U_B, E_B = 0.028575, 0.170097, 0.2, 0.05, 0.95  # pool balls, 1.5 m/s
SPEED = 1.5
CUTS = np.linspace(0.0, 85.0, 171)  # degrees
SPINS = {"full draw": -1.0, "half draw": -0.5, "rolling": 1.0}  # R w / v; with none, models agree
MODELS = ("pooltool", "bottom_slip")  # against mathavan2014
TITLE = "What the other contact models make of a shot, against mathavan2014"
_COLOURS = {"full draw": COLOURS[1], "half draw": COLOURS[2], "rolling": COLOURS[0]}
_LINES = {"pooltool": "-", "bottom_slip": (0, (5, 2))}


@dataclass(frozen=True)
class Gap:
    """Of one model and spin, for each of CUTS."""

    speed: Array  # % of the cue ball's speed: the larger change of the two balls' velocities
    direction: Array  # degrees: change of the object ball's direction


def _shots(spin: float) -> Array:
    """The cue ball comes along y and hits a resting ball off its centre to the right."""
    rows = np.zeros((len(CUTS), 24))
    cut = np.radians(CUTS)
    rows[:, :6] = (R, M, U_S, U_S, U_B, E_B)
    rows[:, 8] = rows[:, 17] = R
    rows[:, 10] = SPEED
    rows[:, 12] = -spin * SPEED / R
    rows[:, 15], rows[:, 16] = 2 * R * np.sin(cut), 2 * R * np.cos(cut)
    return rows


def model_gaps(tool: BenchTool) -> dict[tuple[str, str], Gap]:
    """Gaps by model and spin."""
    found = {}
    for name, spin in SPINS.items():
        cases = _shots(spin)
        truth = tool.expect(cases, "exact", "mathavan2014")
        for model in MODELS:
            found[model, name] = _gap(tool.expect(cases, "exact", model), truth)
    return found


def _gap(other: Array, truth: Array) -> Gap:
    apart = [np.hypot(*(other - truth)[:, k : k + 2].T) for k in (0, 6)]
    angles = [np.degrees(np.arctan2(t[:, 6], t[:, 7])) for t in (other, truth)]
    return Gap(100 * np.maximum(*apart) / SPEED, np.abs(angles[0] - angles[1]))


def draw(gaps: dict[tuple[str, str], Gap]) -> str:
    """Two pictures side by side, as SVG."""
    with figure(columns=2, width=11.0, height=5.4) as (made, (left, right)):
        for (model, spin), gap in gaps.items():
            style = {"color": _COLOURS[spin], "ls": _LINES[model], "lw": 1.6}
            left.plot(CUTS, gap.speed, label=f"{model}, {spin}", **style)
            right.plot(CUTS, gap.direction, **style)
        left.set_ylabel("change of a ball's velocity, % of the cue ball's")
        right.set_ylim(bottom=0)
        right.set_ylabel("change of the object ball's direction, degrees")
        for axes in (left, right):
            axes.set_xlabel("cut angle, degrees")
            axes.set_xlim(0, 85)
        left.set_ylim(bottom=0)
        left.legend()
        made.suptitle(f"{TITLE}\npool balls at {SPEED} m/s, u_b = {U_B}, u_s = {U_S}")
        return svg_of(made, TITLE)


def picture(tool: BenchTool) -> Drawn:
    gaps = model_gaps(tool)
    lines = (
        f"{model}, {spin}: velocities up to {gap.speed.max():.2f} % apart, the object ball's "
        f"direction up to {abs(gap.direction).max():.3f} degrees"
        for (model, spin), gap in gaps.items()
    )
    return Drawn(draw(gaps), tuple(lines))
