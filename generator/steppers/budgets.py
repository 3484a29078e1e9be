"""What each error budget asks of the adaptive stepper: a tableau and the constants of its control.

The constants were calibrated on random hard cases (see docs/accuracy.md); a kernel's budget is
proved by verification, not by this table.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..errors import InputError
from ..tableaus.tableau import Tableau
from ..tableaus.tableaus import TABLEAUS

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
    table_error: float = 1.0  # weight of the errors of table friction; that at the contact is 1
    rest: float = 0.02  # table slip that counts as zero, in tolerances / friction
    safe: float = 0.7  # share of the tolerance that errors are aimed at
    contact_reach: float = 0.7  # without a table: share of the contact slip that a step may remove


@dataclass(frozen=True)
class BudgetPlan:
    """How a budget is met."""

    budget: float
    tableau: Tableau
    control: StepControl


@dataclass(frozen=True)
class _Row:
    """A tableau and its constants for every budget down to `least`."""

    least: float
    tableau: str
    control: StepControl
    driven: StepControl | None = None  # where the table drives its slip on; None: the same
    others: StepControl | None = None  # with another tableau, driven or not; None: the same


_LOOSE = StepControl(0.25, 2.2, 10.0, 0.1, 100.0, 1.0)
_CAREFUL = StepControl(0.09, 2.2, 7.0, 0.05, 100.0, 1.0)
_USUAL = StepControl(0.21, 2.3, 7.0, 0.011, 3.3, 6.0, 3.0, 0.002)
_USUAL_DRIVEN = replace(_USUAL, depart=1.0, tail=8.0)
_FINE = StepControl(0.7, 2.4, 4.5, 0.005, 0.025, 100.0, 3.0, 0.002)
_FINE_DRIVEN = replace(_FINE, tolerance=0.5, tail=1000.0)
_FINEST = StepControl(0.15, 3.0, 4.0, 0.002, 0.005, 100.0, 3.0, 0.02)
_FINEST_DRIVEN = StepControl(0.06, 3.0, 4.0, 0.001, 0.002, 500.0, 3.0, 0.02)

# Between the budgets that a million cases prove, errors of steps into sticking weigh more: how far
# such a step is off hardly falls with the budget, until it is refused (tests/data/hard_cases.csv).
# Rows begin just beside a proved budget (1.1e-6, 1.1e-9, 9e-10), which keeps its own constants.
# _OTHER: above a budget of 1e-7, dop853's long steps end on a cubic, whose error the control
# does not see.
_OTHER = StepControl(0.05, 1.7, 7.0, 0.0167, 3.3, 6.0, 6.0, 0.002)

_PLANS: tuple[_Row, ...] = (  # loosest first
    _Row(1e-3, "ss43", _LOOSE, driven=_CAREFUL, others=replace(_CAREFUL, tail=6.0)),
    _Row(
        9e-5,
        "dp54",
        StepControl(0.075, 2.2, 7.0, 0.05, 10.0, 1.0),
        others=StepControl(0.09, 2.2, 7.0, 0.0167, 10.0, 6.0),
    ),
    _Row(
        1.1e-6,
        "dp54",
        replace(_USUAL, tail=30.0),
        replace(_USUAL_DRIVEN, tail=30.0),
        others=_OTHER,
    ),
    _Row(1e-7, "dp54", _USUAL, _USUAL_DRIVEN, others=_OTHER),
    _Row(1.1e-9, "dop853", replace(_FINE, tail=300.0), _FINE_DRIVEN),
    _Row(9e-10, "dop853", _FINE, _FINE_DRIVEN),
    _Row(1e-10, "dop853", _FINE, _FINE_DRIVEN),
    _Row(TIGHTEST, "dop853", _FINEST, _FINEST_DRIVEN),
)


def plan_for(budget: float, tableau: str | None = None, driven: bool = False) -> BudgetPlan:
    """The plan for a budget; `driven`: does the table drive its slip away from zero?

    Raises InputError where the budget is out of range.
    """
    if not TIGHTEST <= budget <= LOOSEST:
        raise InputError(
            f"--max-error {budget:g}: out of range; expected {TIGHTEST:g} to {LOOSEST:g}"
        )
    for row in _PLANS:
        if budget >= row.least:
            other = tableau not in (None, row.tableau)
            control = (other and row.others) or (driven and row.driven) or row.control
            return BudgetPlan(budget, TABLEAUS[tableau or row.tableau], control)
    raise InputError(f"--max-error {budget:g}: no stepper reaches it")


def tableaus_for(budget: float) -> tuple[str, ...]:
    """Names of the tableaus that are worth trying for a budget."""
    plan_for(budget)
    return tuple(dict.fromkeys(row.tableau for row in _PLANS if budget >= row.least))[:2]
