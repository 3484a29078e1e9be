"""How far off the ways to make an inverse root are, and which a budget allows."""

from __future__ import annotations

from generator.mechanics.terms import drives_its_slip
from generator.scenes.models import find_model
from generator.targets.target import Target

COARSEST_FIRST = ("est0", "est1", "cubic", "est2", "inv")
# What a root is off by may grow: 3.4 times in the worst of 352,840 hard cases, and 23 times where
# the table drives its slip away from zero. The rest of the budget is for the steps.
_SHARE, _SHARE_OF_DRIVEN_SLIP = 1 / 4, 1 / 40


def refined_error(code: str, estimate: float) -> float:
    """Relative error of a root from an estimate that is off by `estimate`; 0: sqrt and division."""
    newton = 1.5 * estimate**2
    errors = {"est0": estimate, "est1": newton, "est2": 1.5 * newton**2, "cubic": 2.5 * estimate**3}
    return errors.get(code, 0.0)


def allows(budget: float, model: str, code: str, target: Target, one_float: bool = False) -> bool:
    """Is an exact stepper's root fine enough for a budget? `one_float`: in one lane, of float."""
    driven = drives_its_slip(find_model(model).terms)
    share = _SHARE_OF_DRIVEN_SLIP if driven else _SHARE
    return refined_error(code, target.rsqrt_error(one_float)) <= budget * share
