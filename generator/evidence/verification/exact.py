"""The verdict on a kernel that must be near the exact result, within a budget of error."""

from __future__ import annotations

import numpy as np

from .errors import Array, Measure
from .verdict import Verdict, failed, status_failure, worst_of


def exact_verdict(
    measure: Measure,
    cases: Array,
    got: Array,
    exact: Array,
    budget: float,
    steep: Array | float = 0.0,
) -> Verdict:
    """`budget`: the largest relative error admitted. Each status must be as expected.

    `steep`: how far a rounding of its input moves the exact result of a case; no kernel can be
    surely nearer.

    Raises KernelError if the tables do not fit each other.
    """
    columns = measure.columns
    expected = {"got": (got, columns.outcome_width), "exact": (exact, columns.expected_width)}
    measure.check_shapes(cases, **expected)
    errors = measure.errors_of(cases, got, exact)
    failure = status_failure(got, exact, errors, columns.status)
    if failure is not None:
        return failure
    allowed = np.maximum(budget, steep)
    beyond = errors.relative > allowed
    worst = worst_of(errors.relative, beyond)
    if worst is not None:
        reason = f"off by {errors.relative[worst]:.3g} of the relative speed, more than {budget:g}"
        return failed(reason, errors, worst)
    return Verdict(
        passed=True,
        reason=f"{len(cases)} cases within {budget:g} of the exact result",
        max_abs_error=float(errors.absolute.max()),
        max_rel_error=float(errors.relative.max()),
        cases=len(cases),
        worst_case=worst_of(errors.relative, errors.relative >= 0),
    )
