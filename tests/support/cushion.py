"""Kernels of the cushion called case by case, and the results that they are held to."""

from __future__ import annotations

import csv
import ctypes
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from generator.evidence.timing.bench_tool import BenchTool, build_bench_tool
from generator.impacts.ball_cushion.columns import COLUMNS
from generator.impacts.ball_cushion.row import BALL_CUSHION
from generator.places import cache_folder
from generator.registry.question import Goal, Question, Width
from generator.registry.variant import Variant, answered
from tests.support.kernels import ROOT

DATA = ROOT / "tests" / "data" / "ball_cushion"
FIXED = "fixed"
_DOUBLES = ctypes.POINTER(ctypes.c_double)


def cushion_variant(
    model: str = "clamped",
    steps: int | None = None,
    budget: float | None = None,
    stepper: str = FIXED,
    target: str = "x86-64-v3",
    scene: str = "any",
    **options: str,
) -> Variant:
    goal = Goal(steps, budget)
    question = Question(BALL_CUSHION.name, target, scene, model, goal, Width())
    return answered(question, stepper, options)


def cushion_tool() -> BenchTool:
    """carom_bench of a ball and a cushion: random cases, and the oracle's answers."""
    return build_bench_tool(cache_folder(), impact=BALL_CUSHION)


@dataclass(frozen=True)
class CushionCases:
    """Rows of the case columns, with ids and kinds."""

    ids: tuple[str, ...]
    kinds: tuple[str, ...]
    rows: np.ndarray

    @property
    def radii(self) -> np.ndarray:
        return self.rows[:, 0]

    @property
    def before(self) -> np.ndarray:
        start = COLUMNS.case.index("vx")
        return self.rows[:, start : start + len(COLUMNS.velocities)]


def load_cases(path: Path = DATA / "inputs.csv") -> CushionCases:
    with path.open(newline="") as stream:
        records = list(csv.DictReader(stream))
    rows = np.array([[float(r[name]) for name in COLUMNS.case] for r in records])
    return CushionCases(tuple(r["id"] for r in records), tuple(r["kind"] for r in records), rows)


def load_outcomes(name: str, ids: tuple[str, ...]) -> np.ndarray:
    """Velocities after, in the order of `ids`; NaN where the file has no such row."""
    with (DATA / name).open(newline="") as stream:
        known = {r["id"]: [float(r[c]) for c in COLUMNS.velocities] for r in csv.DictReader(stream)}
    missing = [float("nan")] * len(COLUMNS.velocities)
    return np.array([known.get(i, missing) for i in ids])


def sizes(velocities: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """The largest of |v| and R |w| of each row, m/s."""
    speeds = np.linalg.norm(velocities[:, :3], axis=1)
    return np.maximum(speeds, radii * np.linalg.norm(velocities[:, 3:], axis=1))


def errors(got: np.ndarray, want: np.ndarray, cases: CushionCases) -> np.ndarray:
    """The largest component of the differences of v and R w, over |v| before."""
    scale = np.column_stack([np.ones((len(got), 3)), np.repeat(cases.radii[:, None], 3, axis=1)])
    speed = np.linalg.norm(cases.before[:, :2], axis=1)
    return np.abs((got - want) * scale).max(axis=1) / speed


class CushionFunction:
    """carom_probe_collide of a library."""

    def __init__(self, library: Path) -> None:
        loaded = ctypes.CDLL(str(library))
        self._collide = loaded.carom_probe_collide
        self._steps = getattr(loaded, "carom_probe_steps", None)
        self._batch = loaded.carom_probe_batch
        self._batch.restype = ctypes.c_size_t

    def __call__(self, rows: np.ndarray, steps: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Velocities and statuses."""
        out, status = np.empty((len(rows), 6)), np.empty(len(rows), dtype=int)
        for n, row in enumerate(np.ascontiguousarray(rows)):
            given = [row[i:].ctypes.data_as(_DOUBLES) for i in (0, 6, 12)]
            place = out[n].ctypes.data_as(_DOUBLES)
            call = self._collide if steps is None else self._steps
            status[n] = call(*given, place, *(() if steps is None else (steps,)))
        return out, status

    def batch(
        self, parameters: np.ndarray, motion: np.ndarray, u_w: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Rows of 8 with parameters that all share."""
        columns = [np.ascontiguousarray(column) for column in motion.T]
        out = [np.empty(len(motion)) for _ in range(6)]
        status = np.empty(len(motion), dtype=np.uint8)
        each = None if u_w is None else np.ascontiguousarray(u_w).ctypes.data_as(_DOUBLES)
        good = self._batch(
            np.ascontiguousarray(parameters).ctypes.data_as(_DOUBLES),
            each,
            ctypes.c_size_t(len(motion)),
            (_DOUBLES * 8)(*(c.ctypes.data_as(_DOUBLES) for c in columns)),
            (_DOUBLES * 6)(*(c.ctypes.data_as(_DOUBLES) for c in out)),
            status.ctypes.data_as(ctypes.c_char_p),
        )
        return np.array(out).T, status, good
