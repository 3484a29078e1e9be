"""Golden vectors: cases and what must come out of them, as a self-test may ask anywhere.

For exact kernels the answers are those of the exact solver in tests/oracle, for fixed steps those
of the scheme in long double. Both are written apart from the generator.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..errors import KernelError
from ..evidence.timing.bench_tool import BenchTool
from ..evidence.verification.errors import (
    SLIPS,
    STATUS,
    STICKS,
    VELOCITIES,
    Array,
    errors_of,
    relative_speed,
)
from ..evidence.verification.euler import TOLERANCE
from ..evidence.verification.reference import EULER_STEPS, load_reference
from ..evidence.verification.scene_cases import cases_for_scene
from ..impacts.ball_ball.parameters import CASE_M1
from ..impacts.ball_ball.parameters import NAMES as PARAMETERS
from ..impacts.ball_ball.scene import Scene
from ..registry.question import Goal

_TRIED = 3  # cases of each kind, until one fits
# The end of a fixed-step loop is a comparison: a case is taken only where inputs moved by rounding
# leave the answer where it is, so that no compiler's rounding can flip it by a step.
_MOVES, _MOVED_BY, _STILL, _SEED = 8, 1e-13, 1e-9, 614


@dataclass(frozen=True)
class GoldenRow:
    """One case; numbers in hexadecimal, so that no digit is lost."""

    kind: str
    radius: str  # m
    most: str  # m/s, the largest error admitted
    speed: str  # m/s, |v1 - v2| before
    params: tuple[str, ...]  # those that the caller gives, in their order
    balls: tuple[str, ...]  # 18
    want: tuple[str, ...]  # v1, w1, v2, w2


def golden_rows(tool: BenchTool, scene: Scene, model: str, goal: Goal) -> tuple[GoldenRow, ...]:
    """One case of each kind of the reference, moved into the scene.

    Raises KernelError where no case of the reference can be moved there.
    """
    kinds, cases = _candidates(scene, model)
    want, fits = _answers(tool, scene, model, goal, cases)
    rows, taken = [], set()
    for kind, case, answer, fit in zip(kinds, cases, want, fits, strict=True):
        shape = case.tobytes()
        if fit and kind not in taken and shape not in taken:
            taken |= {kind, shape}
            rows.append(_row(kind, case, answer, scene, goal))
    if not rows:
        raise KernelError(f"scene {scene.name}: no case of the reference gives a golden vector")
    return tuple(rows)


def _candidates(scene: Scene, model: str) -> tuple[tuple[str, ...], Array]:
    reference = load_reference()
    seen: dict[str, int] = {}
    rows = []
    for index, kind in enumerate(reference.kinds):
        seen[kind] = seen.get(kind, 0) + 1
        if seen[kind] <= _TRIED:
            rows.append(index)
    kinds = tuple(reference.kinds[i] for i in rows)
    return kinds, cases_for_scene(scene, reference.cases[rows], model)


def _answers(
    tool: BenchTool, scene: Scene, model: str, goal: Goal, cases: Array
) -> tuple[Array, Array]:
    """What must come out, and which cases may be asked for."""
    exact = tool.expect(cases, "exact", model, more=scene.oracle_options)
    fits = (exact[:, STATUS] == 0) & (relative_speed(cases) > 0)
    if goal.steps is None:
        return exact, fits
    steps = goal.steps or EULER_STEPS
    want = tool.expect(cases, "euler", model, steps)
    fits &= (exact[:, STICKS] == SLIPS) & (want[:, STICKS] == SLIPS)
    rng = np.random.default_rng(_SEED)
    for _ in range(_MOVES):
        moved = cases * (1 + _MOVED_BY * rng.uniform(-1, 1, cases.shape))
        moved[:, [8, 17]] = cases[:, [8, 17]]  # else the line of centres is tilted
        moved[:, : len(PARAMETERS)] = cases[:, : len(PARAMETERS)]
        found = tool.expect(moved, "euler", model, steps)
        fits &= errors_of(cases, found, want).relative < _STILL
    return want, fits


def _row(kind: str, case: Array, answer: Array, scene: Scene, goal: Goal) -> GoldenRow:
    speed = float(relative_speed(case[None, :])[0])
    most = TOLERANCE if goal.budget is None else goal.budget * speed
    given = {**dict(zip(PARAMETERS, case, strict=False)), "M1": CASE_M1}
    return GoldenRow(
        kind=kind,
        radius=float(case[0]).hex(),
        most=most.hex(),
        speed=speed.hex(),
        params=_hex(given[key] for key in scene.free) or ("0.0",),
        balls=_hex(case[len(PARAMETERS) :]),
        want=_hex(answer[:VELOCITIES]),
    )


def _hex(values: Iterable[float]) -> tuple[str, ...]:
    return tuple("0.0" if value == 0 else float(value).hex() for value in values)
