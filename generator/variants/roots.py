"""How far off the ways to make an inverse root are, and which a budget allows."""

from __future__ import annotations

from generator.scenes.models import find_model
from generator.targets.target import Target

COARSEST_FIRST = ("est0", "est1", "cubic", "est2", "inv")
# A root may be off by a third of the budget. Where the table drives its slip away from zero,
# such an error grows with the slip: 23 times in the worst of 352,840 hard cases.
_SHARE, _SHARE_OF_DRIVEN_SLIP = 1 / 3, 1 / 24


def root_error(code: str, target: Target) -> float:
    """Relative error of an exact stepper's inverse root; 0 for sqrt and division."""
    e = target.rsqrt_error
    errors = {"est0": e, "est1": 1.5 * e**2, "cubic": 2.5 * e**3, "est2": 1.5 * (1.5 * e**2) ** 2}
    return errors.get(code, 0.0)


def allows(budget: float, model: str, code: str, target: Target) -> bool:
    """Is a root fine enough for a budget?"""
    driven = find_model(model).terms.table_slip_point == "top"
    return root_error(code, target) <= budget * (_SHARE_OF_DRIVEN_SLIP if driven else _SHARE)
