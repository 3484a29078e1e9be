"""The verdict on a kernel that must be near the exact result, within a budget of error."""

from __future__ import annotations

from generator.verification.errors import (
    EXPECTED_COLUMNS,
    OUTCOME_COLUMNS,
    Array,
    check_shapes,
    errors_of,
)
from generator.verification.verdict import Verdict, failed, status_failure, worst_of


def exact_verdict(cases: Array, got: Array, exact: Array, budget: float) -> Verdict:
    """`budget`: the largest relative error admitted. Each status must be as expected.

    Raises KernelError if the tables do not fit each other.
    """
    check_shapes(cases, got=(got, OUTCOME_COLUMNS), exact=(exact, EXPECTED_COLUMNS))
    errors = errors_of(cases, got, exact)
    failure = status_failure(got, exact, errors)
    if failure is not None:
        return failure
    worst = worst_of(errors.relative, errors.relative >= 0)
    assert worst is not None
    if not errors.relative[worst] <= budget:
        reason = f"off by {errors.relative[worst]:.3g} of the relative speed, more than {budget:g}"
        return failed(reason, errors, worst)
    return Verdict(
        passed=True,
        reason=f"{len(cases)} cases within {budget:g} of the exact result",
        max_abs_error=float(errors.absolute.max()),
        max_rel_error=float(errors.relative.max()),
        cases=len(cases),
        worst_case=worst,
    )
