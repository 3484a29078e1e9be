"""The reference of two balls, their kept hard cases, and the verdict on their exact kernels."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from generator.evidence.challenge import kept
from generator.evidence.verification import exact, hard_cases, reference
from generator.evidence.verification.errors import Array
from generator.evidence.verification.reference import Reference, ReferenceFiles
from generator.evidence.verification.verdict import Verdict
from generator.impacts.ball_ball.evidence import EVIDENCE, REFERENCE
from generator.impacts.ball_ball.evidence.measure import CASE_NAMES, MEASURE

FOLDER = REFERENCE.folder
FILE = EVIDENCE.hard_cases


def load_reference(folder: Path = FOLDER) -> Reference:
    files = ReferenceFiles(folder, REFERENCE.columns, REFERENCE.exact, REFERENCE.published)
    return reference.load_reference(files)


def load_hard(path: Path = FILE) -> tuple[tuple[str, ...], Array]:
    return hard_cases.load_hard(path, CASE_NAMES)


def hexfloats(case: Array) -> str:
    return kept.hexfloats(case, CASE_NAMES)


def keep(found: Sequence[tuple[str, Array]], path: Path = FILE) -> int:
    return kept.keep(found, path, CASE_NAMES)


def exact_verdict(
    cases: Array, got: Array, want: Array, budget: float, steep: Array | float = 0.0
) -> Verdict:
    return exact.exact_verdict(MEASURE, cases, got, want, budget, steep)
