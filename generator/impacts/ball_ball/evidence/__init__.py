"""How kernels of two balls are judged: what the rooms of evidence ask of this impact."""

from __future__ import annotations

from ....evidence.verification.evidence import Evidence
from ....evidence.verification.reference import DATA, ReferenceFiles
from ..columns import COLUMNS, R1, R2
from ..parameters import CASE_M1, MASS_1
from .fixed_steps import FLIP_SHARE, TOLERANCE, euler_verdict
from .measure import MEASURE
from .scene_cases import cases_for_scene

MODELS = ("mathavan2014", "bottom_slip", "pooltool")
EULER_STEPS = 1000  # of pooltool's own answers
PUBLISHED = ("pooltool", EULER_STEPS)
REFERENCE = ReferenceFiles(
    folder=DATA / "reference",
    columns=COLUMNS,
    exact={model: f"exact_{model}.csv" for model in MODELS},
    published={PUBLISHED: "euler_n1000.csv"},
)
# A batch has one R, M, u_s and e_b: those of a pool table.
SHARED = {"R": 0.028575, "M": 0.170097, "u_s1": 0.2, "u_s2": 0.2, "e_b": 0.95}
EASY = ("rolling_vs_rest", "stun_vs_rest", "draw_vs_rest", "side_vs_rest", "break")

EVIDENCE = Evidence(
    measure=MEASURE,
    reference=REFERENCE,
    hard_cases=DATA / "hard_cases.csv",
    shared=SHARED,
    seeds="seed_case",
    cases_for_scene=cases_for_scene,
    fixed_verdict=euler_verdict,
    tolerance=TOLERANCE,
    flip_share=FLIP_SHARE,
    level=(R1.stop - 1, R2.stop - 1),  # else the line of centres is tilted
    given={MASS_1: CASE_M1},
    easy=frozenset(EASY),
)
