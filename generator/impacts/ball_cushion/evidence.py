"""How kernels of a ball and a cushion are judged: what the rooms of evidence ask of this impact.

Fixed steps are compared with pooltool's scheme in double, whose comparisons and angles rounding may
turn: such a flip may leave a kernel twice as far from the exact result as the scheme itself is, in
at most FLIP_SHARE of the cases.
"""

from __future__ import annotations

import numpy as np

from ...evidence.verification.errors import Array, Measure
from ...evidence.verification.evidence import Evidence
from ...evidence.verification.reference import DATA, ReferenceFiles
from ...evidence.verification.scene_ranges import move_parameters
from ...evidence.verification.verdict import (
    Verdict,
    failed,
    largest_of,
    status_failure,
    worst_of,
)
from .columns import COLUMNS
from .scene import Scene

FOLDER = DATA / "ball_cushion"
TOLERANCE = 1e-9  # of the ball's speed, and of R w where that is more
FLIP_SHARE = 0.02
_NORMAL = (COLUMNS.case.index("nx"), COLUMNS.case.index("ny"))
_SPEED = list(COLUMNS.speeds)


def ball_speed(cases: Array) -> Array:
    """|v| before, m/s."""
    with np.errstate(invalid="ignore", over="ignore"):
        speed: Array = np.linalg.norm(cases[:, _SPEED], axis=1)
        return speed


MEASURE = Measure(COLUMNS, ball_speed)


def cases_for_scene(scene: Scene, rows: Array, model: str | None = None) -> Array:
    """The cases, changed where they lie outside the scene; one row for each that is given.

    A nose that is below the centre then, or above the ball, goes to as many radii as before.
    """
    cases = np.array(rows, dtype=np.float64, copy=True)
    move_parameters(cases, COLUMNS, scene)
    radius, height = (COLUMNS.case.index(name) for name in ("R", "h"))
    if "h" not in scene.fixed and "h" not in scene.ranges:
        cases[:, height] = rows[:, height] / rows[:, radius] * cases[:, radius]
        same = cases[:, radius] == rows[:, radius]
        cases[same, height] = rows[same, height]
    return cases


def fixed_verdict(
    cases: Array,
    got: Array,
    euler: Array,
    exact: Array,
    steps: int,
    flip_share: float = FLIP_SHARE,
) -> Verdict:
    """`euler`: pooltool's scheme with as many `steps`; `exact`: the exact result."""
    expected = {"euler": (euler, COLUMNS.expected_width), "exact": (exact, COLUMNS.expected_width)}
    MEASURE.check_shapes(cases, got=(got, COLUMNS.outcome_width), **expected)
    errors = MEASURE.errors_of(cases, got, euler)
    failure = status_failure(got, euler, errors, COLUMNS.status)
    if failure is not None:
        return failure
    allowed = np.maximum(TOLERANCE, TOLERANCE / (4 * 2.0**-52) * MEASURE.rounding_of(cases))
    flipped = ~(errors.relative <= allowed)
    flips = tuple(int(i) for i in np.flatnonzero(flipped))
    own = MEASURE.errors_of(cases, euler, exact).relative
    far = np.flatnonzero(flipped & ~(MEASURE.errors_of(cases, got, exact).relative <= 2 * own))
    if len(far):
        case = int(far[0])
        reason = (
            f"{errors.relative[case]:.3g} of the speed from the scheme, more than {TOLERANCE:g}"
        )
        return failed(f"{reason}, and than twice what it is off itself", errors, case, flips)
    if len(flips) > flip_share * len(cases):
        reason = (
            f"one of {len(flips)} flips in {len(cases)} cases, more than {100 * flip_share:g} %"
        )
        return failed(reason, errors, flips[0], flips)
    return Verdict(
        passed=True,
        reason=f"{len(cases) - len(flips)} cases within {TOLERANCE:g} of the scheme, "
        f"{len(flips)} flips",
        max_abs_error=largest_of(errors.absolute, ~flipped),
        max_rel_error=largest_of(errors.relative, ~flipped),
        cases=len(cases),
        flips=flips,
        worst_case=worst_of(errors.relative, ~flipped),
        max_flip_error=largest_of(errors.absolute, flipped),
    )


EVIDENCE = Evidence(
    measure=MEASURE,
    reference=ReferenceFiles(
        folder=FOLDER,
        columns=COLUMNS,
        published={("pooltool", 1000): "pooltool.csv", ("pooltool", 5000): "pooltool_fine.csv"},
    ),
    hard_cases=FOLDER / "hard_cases.csv",
    shared={"R": 0.028575, "M": 0.170097, "u_s": 0.2, "e_c": 0.85, "h": 0.036576},  # pool
    seeds="roll",
    cases_for_scene=cases_for_scene,
    fixed_verdict=fixed_verdict,
    tolerance=TOLERANCE,
    flip_share=FLIP_SHARE,
    exact_models={"pooltool": "printed"},
    level=_NORMAL,
)
