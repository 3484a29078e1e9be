from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from generator.evidence.verification.errors import Array, Measure
from generator.evidence.verification.evidence import Evidence
from generator.evidence.verification.reference import ReferenceFiles
from generator.evidence.verification.scene_ranges import move_parameters
from generator.evidence.verification.verdict import Verdict

from .row import COLUMNS

HERE = Path(__file__).parent


def cases_for_scene(scene: Any, rows: Array, model: str | None = None) -> Array:
    cases = np.array(rows)
    move_parameters(cases, COLUMNS, scene)
    return cases


def no_fixed_steps(*_: object) -> Verdict:
    raise AssertionError("there are no fixed steps")


EVIDENCE = Evidence(
    measure=Measure(COLUMNS, lambda cases: np.linalg.norm(cases[:, COLUMNS.speeds], axis=1)),
    reference=ReferenceFiles(HERE, COLUMNS),
    hard_cases=HERE / "hard_cases.csv",
    shared={"R": 0.03},
    seeds="plain",
    cases_for_scene=cases_for_scene,
    fixed_verdict=no_fixed_steps,
    tolerance=1e-9,
    flip_share=0.0,
)
