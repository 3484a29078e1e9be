"""What a verification ends with, and what all verifications check first."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from .errors import Array, Errors, Mask


@dataclass(frozen=True)
class Verdict:
    """Passed or not, why, and the largest errors found.

    The errors are those of the cases held to the main tolerance. Flips and, for fixed steps, cases
    whose contact sticks have their own.
    """

    passed: bool
    reason: str  # one line; what held when passed
    max_abs_error: float  # m/s
    max_rel_error: float  # of what the impact measures errors by
    cases: int
    flips: tuple[int, ...] = ()
    worst_case: int | None = None  # the row with the largest relative error, or the one that failed
    max_flip_error: float = 0.0  # m/s
    sticking: int = 0  # cases that were compared with the exact result instead
    max_sticking_rel_error: float = 0.0  # of those, against the exact result
    ended: Literal["", "crash", "timeout"] = ""  # before there was any result
    worst_estimate_error: float | None = None  # largest relative; None: no estimate enters

    @property
    def largest_error(self) -> float:
        """Relative, on this CPU or under the worst root estimates."""
        return max(self.max_rel_error, self.worst_estimate_error or 0.0)


def failed(reason: str, errors: Errors, case: int, flips: tuple[int, ...] = ()) -> Verdict:
    """A verdict of failure that names the case."""
    largest = float(errors.absolute.max()), float(errors.relative.max())
    return Verdict(False, f"case {case}: {reason}", *largest, len(errors.absolute), flips, case)


def with_worst(native: Verdict, worst: Verdict) -> Verdict:
    """A verdict found on this CPU, and the one under the worst root estimates, as one."""
    if not worst.passed:
        return worst
    return replace(native, worst_estimate_error=worst.max_rel_error)


def worst_of(errors: Array, among: Mask) -> int | None:
    """The row with the largest error of those marked in `among`."""
    rows = np.flatnonzero(among)
    return int(rows[np.argmax(errors[rows])]) if len(rows) else None


def largest_of(errors: Array, among: Mask) -> float:
    """The largest error of those marked in `among`; 0 if there are none."""
    return float(errors[among].max(initial=0.0))


def status_failure(got: Array, want: Array, errors: Errors, status: int) -> Verdict | None:
    """A failure where a status differs, or where a case without an outcome has been changed.

    `status`: the column that holds it.
    """
    if len(got) == 0:
        return Verdict(False, "there is no case to verify", 0.0, 0.0, 0)
    wrong = np.flatnonzero(~(got[:, status] == want[:, status]))
    if len(wrong):
        case = int(wrong[0])
        return failed(f"status {got[case, status]:g}, not {want[case, status]:g}", errors, case)
    changed = np.flatnonzero((want[:, status] != 0) & (errors.absolute != 0))
    if len(changed):
        case = int(changed[0])
        return failed(f"status {want[case, status]:g}, but velocities changed", errors, case)
    return None
