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
from ..evidence.verification.errors import SLIPS, Array
from ..evidence.verification.evidence import evidence_of
from ..evidence.verification.reference import load_reference
from ..impacts.impact import Impact
from ..impacts.scene import BaseScene
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
    speed: str  # m/s, what errors are relative to
    params: tuple[str, ...]  # those that the caller gives, in their order
    bodies: tuple[str, ...]
    want: tuple[str, ...]  # velocities


@dataclass(frozen=True)
class _Wanted:
    scene: BaseScene
    goal: Goal


def golden_rows(tool: BenchTool, scene: BaseScene, model: str, goal: Goal) -> tuple[GoldenRow, ...]:
    """One case of each kind of the reference, moved into the scene.

    Raises KernelError where no case of the reference can be moved there.
    """
    kinds, cases = _candidates(tool.impact, scene, model)
    want, fits = _answers(tool, scene, model, goal, cases)
    rows, taken = [], set()
    for kind, case, answer, fit in zip(kinds, cases, want, fits, strict=True):
        shape = case.tobytes()
        if fit and kind not in taken and shape not in taken:
            taken |= {kind, shape}
            rows.append(_row(tool.impact, kind, case, answer, _Wanted(scene, goal)))
    if not rows:
        raise KernelError(f"scene {scene.name}: no case of the reference gives a golden vector")
    return tuple(rows)


def _candidates(impact: Impact, scene: BaseScene, model: str) -> tuple[tuple[str, ...], Array]:
    evidence = evidence_of(impact)
    reference = load_reference(evidence.reference)
    seen: dict[str, int] = {}
    rows = []
    for index, kind in enumerate(reference.kinds):
        seen[kind] = seen.get(kind, 0) + 1
        if seen[kind] <= _TRIED:
            rows.append(index)
    kinds = tuple(reference.kinds[i] for i in rows)
    return kinds, evidence.cases_for_scene(scene, reference.cases[rows], model)


def _answers(
    tool: BenchTool, scene: BaseScene, model: str, goal: Goal, cases: Array
) -> tuple[Array, Array]:
    """What must come out, and which cases may be asked for."""
    evidence, columns = evidence_of(tool.impact), tool.columns
    measure, sticks = evidence.measure, columns.sticks
    exact = tool.expect(cases, "exact", model, more=scene.oracle_options)
    fits = (exact[:, columns.status] == 0) & (measure.speed(cases) > 0)
    if goal.steps is None:
        return exact, fits
    want = tool.expect(cases, "euler", model, goal.steps)
    fits &= (exact[:, sticks] == SLIPS) & (want[:, sticks] == SLIPS)
    held = [*range(len(columns.parameters)), *evidence.level]
    rng = np.random.default_rng(_SEED)
    for _ in range(_MOVES):
        moved = cases * (1 + _MOVED_BY * rng.uniform(-1, 1, cases.shape))
        moved[:, held] = cases[:, held]
        found = tool.expect(moved, "euler", model, goal.steps)
        fits &= measure.errors_of(cases, found, want).relative < _STILL
    return want, fits


def _row(impact: Impact, kind: str, case: Array, answer: Array, wanted: _Wanted) -> GoldenRow:
    evidence, columns = evidence_of(impact), impact.columns
    goal, one = wanted.goal, case[None, :]
    speed = float(evidence.measure.speed(one)[0])
    most = evidence.tolerance if goal.budget is None else goal.budget * speed
    given = {**dict(zip(columns.parameters, case, strict=False)), **evidence.given}
    return GoldenRow(
        kind=kind,
        radius=float(evidence.measure.radius(one)[0, 0]).hex(),
        most=most.hex(),
        speed=speed.hex(),
        params=_hex(given[key] for key in wanted.scene.free) or ("0.0",),
        bodies=_hex(case[len(columns.parameters) :]),
        want=_hex(answer[: columns.status]),
    )


def _hex(values: Iterable[float]) -> tuple[str, ...]:
    return tuple("0.0" if value == 0 else float(value).hex() for value in values)
