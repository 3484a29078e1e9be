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
    contact_reach: float  # alpha: share of the contact slip that one step may remove
    table_reach: float  # kappa: scale of a step near the closest approach of the table slip to zero
    window: float  # radius around zero table slip that counts as zero, in tolerance / friction
    landing: float  # error allowed to the Taylor move that ends a phase, in tolerances
    slope_error: float  # how far the slope of the rates may be off, in their change over a step
    tail: float  # error allowed to the closed form of sticking, in tolerances


@dataclass(frozen=True)
class BudgetPlan:
    """How a budget is met."""

    budget: float
    tableau: Tableau
    control: StepControl


_CONTROL = StepControl(0.1, 0.7, 1.4, 0.1, 0.1, 0.03, 0.2)

# Loosest budget first; a plan serves every budget down to its own `budget`.
_PLANS: tuple[tuple[float, str, StepControl], ...] = (
    (1e-3, "dp54", _CONTROL),
    (TIGHTEST, "dp54", _CONTROL),
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
