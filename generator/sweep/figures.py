"""Figures as records hold them, out of verdicts and rounds."""

from __future__ import annotations

import math

import numpy as np

from ..choice.workbench import Candidate
from ..evidence.timing.ratios import TimingRun, control_band, timing_results
from .record import Errors, Times

_DIGITS = 5


def rounded(value: float) -> float:
    """To as many digits as records keep."""
    return float(f"{value:.{_DIGITS}g}")


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def times_of(run: TimingRun, name: str) -> Times:
    """What a timing says of a kernel, against the baseline in the same rounds."""
    result = next(r for r in timing_results(run) if r.name == name)
    base = run.throughput.ns[run.baseline]
    low, high = result.ratio_ci
    control = control_band(run)
    return Times(
        ns=rounded(result.ns),
        cycles=rounded(result.cycles),
        ratio=rounded(result.ratio),
        ratio_ci=(rounded(low), rounded(high)),
        control=(rounded(control[0]), rounded(control[1])),
        baseline_ns=rounded(float(np.median(base))),
        rounds=run.rounds,
        quiet=rounded(run.quiet),
        ratios=tuple(rounded(float(r)) for r in run.throughput.ns[name] / base),
    )


def errors_of(candidate: Candidate) -> Errors | None:
    """The verdict of a candidate, if it has one."""
    verdict = candidate.verdict
    if verdict is None:
        return None
    return Errors(
        passed=not candidate.rejected,
        reason=" ".join((candidate.rejected or verdict.reason).split()),
        max_abs_error=_known(verdict.max_abs_error),
        max_rel_error=_known(verdict.max_rel_error),
        against="euler" if candidate.variant.stepper.family == "fixed" else "exact",
        cases=verdict.cases,
        flips=len(verdict.flips),
        worst_case=verdict.worst_case,
        max_flip_error=verdict.max_flip_error,
        sticking=verdict.sticking,
        max_sticking_rel_error=verdict.max_sticking_rel_error,
    )
