"""What each error budget asks of the adaptive stepper: a tableau and the constants of its control.

The constants were calibrated on random hard cases (see docs/accuracy.md); a kernel's budget is
proved by verification, not by this table.
"""

from __future__ import annotations

from dataclasses import dataclass

from generator.errors import InputError
from generator.steppers.tableaus import TABLEAUS, Tableau

LOOSEST, TIGHTEST = 1e-1, 1e-12


@dataclass(frozen=True)
class StepControl:
    """Constants of the step control, all relative to the tolerance or dimensionless."""

    tolerance: float  # tolerance of a step, as a share of the budget
    contact_turn: float  # scale of steps by the turning of the contact slip
    table_reach: float  # scale of steps by the distance of the table slip from zero
    passage: float  # error that one passage of the table slip by zero may make, in tolerances
    depart: float  # error that the first step from rest may make, in tolerances
    tail: float  # weight of the error of the step into sticking
    table_error: float = 1.0  # weight of the errors of table friction; that between the balls is 1
    rest: float = 0.02  # table slip that counts as zero, in tolerances / friction
    safe: float = 0.7  # share of the tolerance that errors are aimed at
    contact_reach: float = 0.7  # without a table: share of the contact slip that a step may remove


@dataclass(frozen=True)
class BudgetPlan:
    """How a budget is met."""

    budget: float
    tableau: Tableau
    control: StepControl


# Loosest budget first; a plan serves every budget down to its own `budget`.
_PLANS: tuple[tuple[float, str, StepControl], ...] = (
    (1e-3, "ss43", StepControl(0.09, 2.2, 7.0, 0.05, 100.0, 1.0)),
    (9e-5, "dp54", StepControl(0.09, 2.2, 7.0, 0.05, 10.0, 1.0)),
    (1e-5, "dp54", StepControl(0.11, 2.2, 7.0, 0.05, 10.0, 1.0)),
    (1e-7, "dp54", StepControl(0.21, 2.3, 7.0, 0.0167, 3.3, 6.0, 3.0, 0.002)),
    (1e-10, "dop853", StepControl(1.0, 2.4, 4.5, 0.005, 0.025, 100.0, 3.0, 0.002)),
    (TIGHTEST, "dop853", StepControl(0.15, 3.0, 4.0, 0.002, 0.005, 100.0, 3.0, 0.02)),
)


def plan_for(budget: float, tableau: str | None = None) -> BudgetPlan:
    """The plan for a budget. Raises InputError where the budget is out of range."""
    if not TIGHTEST <= budget <= LOOSEST:
        raise InputError(
            f"--max-error {budget:g}: out of range; expected {TIGHTEST:g} to {LOOSEST:g}"
        )
    for least, name, control in _PLANS:
        if budget >= least:
            return BudgetPlan(budget, TABLEAUS[tableau or name], control)
    raise InputError(f"--max-error {budget:g}: no stepper reaches it")


def tableaus_for(budget: float) -> tuple[str, ...]:
    """Names of the tableaus that are worth trying for a budget."""
    plan_for(budget)
    return tuple(dict.fromkeys(name for least, name, _ in _PLANS if budget >= least))[:2]
