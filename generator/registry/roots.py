"""How far off the ways to make an inverse root are, and which a budget allows."""

from __future__ import annotations

from ..impacts.ball_ball.models import find_model
from ..impacts.ball_ball.scene import find_scene
from ..impacts.ball_ball.terms import drives_its_slip
from ..targets.target import Target
from .variant import Variant

EXACT_ROOTS = ("inv", "ieee")  # by sqrt and division
COARSEST_FIRST = ("est0", "est1", "cubic", "est2", "inv")
# Friction is made by multiplying with an inverse root, so a root that is off by a share is friction
# that is off by that share. How much of it the exact result is then off by, relative to |v1 - v2|:
# the most that the oracle finds, whatever kernel there is (tests/kernels/test_worst_estimates.py).
# Where the table drives its slip away from zero, a slip that just passes zero grows for long after.
_AMPLIFICATION, _AMPLIFICATION_OF_DRIVEN_SLIP = 2.4, 148.0
# What friction is off by where the slips that it follows are rounded to floats: a unit in the last
# place. Seen: 2e-7 of the result in 352,840 hard cases, 1.5e-5 with a driven slip (batches.md).
FLOAT_ROUNDING = 2.0**-23
# Of a budget that roots, and that rounding may take up; the rest is for the steps. A driven slip
# has both in the same rare passages, where the steps' own error is small.
_SHARE_OF_ROOTS, _SHARE_OF_FLOATS = 1 / 2, 1 / 3


def _driven(model: str) -> bool:
    """Does the table drive its slip away from zero?"""
    return drives_its_slip(find_model(model).terms)


def amplification(model: str) -> float:
    """What a relative error of friction is multiplied by, at most, in a collision's result."""
    return _AMPLIFICATION_OF_DRIVEN_SLIP if _driven(model) else _AMPLIFICATION


def is_reproducible(variant: Variant) -> bool:
    """Are a kernel's bits what IEEE 754 says, on every CPU that has its instructions?

    It must neither estimate roots nor leave it to the compiler what is fused or reordered.
    """
    codes = {variant.get(key) for key in ("rsqrt", "root", "lane_root")}
    exact = variant.stepper.family == "exact" and not find_scene(variant.scene).level
    estimates = codes & {"est0", "est1", "est2", "cubic"} or (exact and "inv" in codes)
    estimates = estimates or variant.get("lane_root") == "inv"
    return not estimates and variant.rounds_as_written


def refined_error(code: str, estimate: float) -> float:
    """Relative error of a root from an estimate that is off by `estimate`; 0: sqrt and division."""
    newton = 1.5 * estimate**2
    errors = {"est0": estimate, "est1": newton, "est2": 1.5 * newton**2, "cubic": 2.5 * estimate**3}
    return errors.get(code, 0.0)


def allows(
    budget: float,
    model: str,
    code: str,
    target: Target,
    one_float: bool = False,
    in_floats: bool = False,
) -> bool:
    """Is an exact stepper's root fine enough for a budget?

    `one_float`: in one lane, of float; `in_floats`: in lanes of float within a scene of doubles.
    """
    error, share = refined_error(code, target.rsqrt_error(one_float)), _SHARE_OF_ROOTS
    if _driven(model):
        share += _SHARE_OF_FLOATS
        error += FLOAT_ROUNDING if in_floats else 0.0
    return error * amplification(model) <= budget * share


def allows_floats(budget: float, model: str) -> bool:
    """May the steps of a collision be made in floats?"""
    share = _SHARE_OF_FLOATS + (_SHARE_OF_ROOTS if _driven(model) else 0.0)
    return FLOAT_ROUNDING * amplification(model) <= budget * share
