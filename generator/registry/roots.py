"""How far off the ways to make an inverse root are, and which a budget allows."""

from __future__ import annotations

from ..impacts.impact import Sensitivity
from ..targets.target import Target
from .variant import Variant

EXACT_ROOTS = ("inv", "ieee")  # by sqrt and division
COARSEST_FIRST = ("est0", "est1", "cubic", "est2", "inv")
# Friction is made by multiplying with an inverse root, so a root that is off by a share is friction
# that is off by that share; `Impact.sensitivity` says what the result is then off by.
# What friction is off by where the slips that it follows are rounded to floats: a unit in the last
# place. Seen: 2e-7 of the result in 352,840 hard cases, 1.5e-5 with a driven slip (batches.md).
FLOAT_ROUNDING = 2.0**-23
# Of a budget that roots, and that rounding may take up; the rest is for the steps.
_SHARE_OF_ROOTS, _SHARE_OF_FLOATS = 1 / 2, 1 / 3


def is_reproducible(variant: Variant) -> bool:
    """Are a kernel's bits what IEEE 754 says, on every CPU that has its instructions?

    It must neither estimate roots nor leave it to the compiler what is fused or reordered.
    """
    codes = {variant.get(key) for key in ("rsqrt", "root", "lane_root")}
    exact = variant.stepper.family == "exact" and not variant.question.known_scene.closed_form
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
    friction: Sensitivity,
    code: str,
    target: Target,
    one_float: bool = False,
    in_floats: bool = False,
) -> bool:
    """Is an exact stepper's root fine enough for a budget?

    `one_float`: in one lane, of float; `in_floats`: in lanes of float within a scene of doubles.
    """
    error, share = refined_error(code, target.rsqrt_error(one_float)), _SHARE_OF_ROOTS
    if friction.adds_up:
        share += _SHARE_OF_FLOATS
        error += FLOAT_ROUNDING if in_floats else 0.0
    return error * friction.amplification <= budget * share


def allows_floats(budget: float, friction: Sensitivity) -> bool:
    """May the steps of a collision be made in floats?"""
    share = _SHARE_OF_FLOATS + (_SHARE_OF_ROOTS if friction.adds_up else 0.0)
    return FLOAT_ROUNDING * friction.amplification <= budget * share
