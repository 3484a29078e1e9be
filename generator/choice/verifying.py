"""Verdicts on a library over cases whose answers are known, and under the worst root estimates."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

import numpy as np

from ..errors import KernelCrash, KernelError, KernelTimeout
from ..evidence.verification.errors import Array
from ..evidence.verification.evidence import evidence_of
from ..evidence.verification.exact import exact_verdict
from ..evidence.verification.verdict import Verdict
from ..evidence.verification.worst_estimates import PATTERNS
from ..registry.variant import Variant

Run = Callable[[Array, bool], Array]  # cases' outcomes, one by one or as a batch


@dataclass(frozen=True)
class HardCases:
    """The kept hard cases, moved into the scene: exact kernels must hold on them too."""

    cases: Array
    exact: Array
    steep: Array  # how far a rounding of the input moves the exact result, relative


@dataclass(frozen=True)
class Expected:
    """Cases and what must come out of them, for one scene and model."""

    scene: str
    cases: Array
    exact: Array
    euler: Array | None  # None where nobody asks, or the scene has no fixed-step kernels
    reference_rows: int  # how many of them are the committed reference
    seed: int
    labels: tuple[str, ...]  # what a reader calls each case, the hard ones last
    pooltool: Array | None  # what pooltool itself gives for the reference, where it can
    key: str  # hash of all of this
    hard: HardCases


def verdicts(run: Run, variant: Variant, expected: Expected) -> dict[str, Any]:
    """A verdict against the oracles and one against pooltool's figures: calls, then batches."""
    kept = _verdicts_of_calls(run, variant, expected, batch=False)
    if variant.width == 1 or not kept["oracle"]["passed"]:
        return kept
    return _verdicts_of_calls(run, variant, expected, batch=True)


def _verdicts_of_calls(
    run: Run, variant: Variant, expected: Expected, batch: bool
) -> dict[str, Any]:
    """The same for calls one by one, or of the batch function."""
    cases, exact, steep = expected.cases, expected.exact, np.zeros(len(expected.cases))
    goal = variant.question.goal
    if goal.budget is not None:
        cases = np.vstack([cases, expected.hard.cases])
        exact = np.vstack([exact, expected.hard.exact])
        steep = np.concatenate([steep, expected.hard.steep])
    try:
        got = run(cases, batch)
    except KernelError as error:
        return {"oracle": broken(error, expected), "pooltool": None}
    if goal.budget is not None:
        measure = evidence_of(variant.question.row).measure
        verdict = exact_verdict(measure, cases, got, exact, goal.budget, steep)
        return {"oracle": asdict(verdict), "pooltool": None}
    return _verdicts_of_scheme(variant, got, expected)


def _verdicts_of_scheme(variant: Variant, got: Array, expected: Expected) -> dict[str, Any]:
    """Of fixed steps: against the same scheme, and pooltool's own where it is known."""
    cases, exact, steps = expected.cases, expected.exact, variant.stepper.steps or 0
    evidence = evidence_of(variant.question.row)
    if expected.euler is None:
        raise KernelError(f"scene {expected.scene}: no fixed-step results are known")
    verdict = evidence.fixed_verdict(cases, got, expected.euler, exact, steps)
    theirs = None
    if expected.pooltool is not None:
        n, columns = expected.reference_rows, variant.question.row.columns
        marks = expected.euler[:n, columns.sticks :]
        own = np.hstack([expected.pooltool[:, : columns.outcome_width], marks])
        share = evidence.flip_share * len(cases) / n  # flips count over all cases
        theirs = asdict(evidence.fixed_verdict(cases[:n], got[:n], own, exact[:n], steps, share))
    return {"oracle": asdict(verdict), "pooltool": theirs}


def worst_verdict(
    under: Callable[[Mapping[str, str]], Run], variant: Variant, expected: Expected
) -> dict[str, Any]:
    """The verdict with the largest error over all patterns of estimates, or the first failure.

    `under`: how a library with replaced estimates is run, with the variables of a pattern.
    """
    held: list[Verdict] = []
    for pattern in PATTERNS:
        both = verdicts(under(pattern.environment()), variant, expected)
        for verdict in (verdict_from(v) for v in both.values() if v is not None):
            if not verdict.passed:
                reason = f"with root estimates {pattern.name}: {verdict.reason}"
                return asdict(replace(verdict, reason=reason))
            held.append(verdict)
    return asdict(max(held, key=lambda v: v.max_rel_error))


def broken(error: KernelError, expected: Expected) -> dict[str, Any]:
    """The verdict on what ended before there was any result."""
    nan = float("nan")
    return asdict(Verdict(False, str(error), nan, nan, len(expected.cases), ended=_ended(error)))


def _ended(error: KernelError) -> Literal["", "crash", "timeout"]:
    if isinstance(error, KernelTimeout):
        return "timeout"
    return "crash" if isinstance(error, KernelCrash) else ""


def verdict_from(document: dict[str, Any]) -> Verdict:
    return Verdict(**{**document, "flips": tuple(document["flips"])})
