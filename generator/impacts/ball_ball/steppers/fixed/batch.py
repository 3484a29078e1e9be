"""What the templates of fixed-step batches may see."""

from __future__ import annotations

from dataclasses import dataclass

from .....lowering.lanes import LaneContext
from .....lowering.printer import number
from .....registry.roots import refined_error
from .....registry.variant import Variant
from ...terms import ContactTerms
from .lanes import CONTACT, LaneLowering

# Lines of 2 / sqrt(n): the factor 2 saves a product and is undone in constants.
_ROOTS = {
    "inv": ("return real(2.0) * x / sqrt(n);",),
    "ieee": ("return real(2.0) * x / sqrt(n);",),
    "est1": (
        "const Real y = rsqrt_estimate(n);",
        "return x * y * fma(-n, y * y, real(3.0));",
    ),
    "est2": (
        "const Real y = rsqrt_estimate(n);",
        "const Real z = y * fma(-n, y * y, real(3.0));",
        "return x * z * fma(real(-0.125) * n, z * z, real(1.5));",
    ),
    "cubic": (
        "const Real y = rsqrt_estimate(n);",
        "const Real off = fma(-n, y * y, real(1.0));",
        "return x * y * fma(off, fma(real(0.75), off, real(1.0)), real(2.0));",
    ),
}


@dataclass(frozen=True)
class FixedStepBatch:
    """Numbers and lines of templates/ball_ball/fixed_step/lanes, there called `b`."""

    refill_at: int
    chatter_at: int
    root: tuple[str, ...]
    root_text: str
    before: tuple[str, ...]  # the slips and v_n of a contact
    slips: tuple[str, ...]  # the slips alone
    steady_rates: tuple[str, ...]
    steady: tuple[str, ...]
    level: tuple[str, ...]
    chatter: tuple[str, ...]
    sums: tuple[str, ...]
    sums_both: tuple[str, ...]
    after: tuple[str, ...]
    per_level_x: str
    drive: str  # what v_n gains in a step without table friction, in dq
    take: (
        float  # steps that may be taken at once use up half of |c|: 4 times what one takes at most
    )
    take_s: float  # the same, for the share of table friction
    sure: float  # of a number of steps that is made by estimates
    contact: tuple[str, ...] = CONTACT


def fixed_step_batch(variant: Variant, terms: ContactTerms, lanes: LaneContext) -> FixedStepBatch:
    """Decide everything that a fixed-step batch's templates show."""
    low = LaneLowering(terms, variant["fma"] == "fma")
    finished = variant["finished"]
    taken, taken_s = low.most_taken()
    return FixedStepBatch(
        refill_at=max(1, lanes.whole // 8) if finished == "refilled" else lanes.whole,
        chatter_at=1 if finished == "masked" else lanes.whole,
        root=_ROOTS[variant["lane_root"]],
        root_text=_root_text(variant["lane_root"], lanes),
        before=low.before().lines,
        slips=low.before(slips_only=True).lines,
        steady_rates=low.steady_rates().lines,
        steady=low.steady().lines,
        level=low.level().lines,
        chatter=low.chatter().lines,
        sums=low.sums().lines,
        sums_both=low.sums_both().lines,
        after=low.after().lines,
        per_level_x=low.per_level_x(),
        drive=number(low.drive()),
        take=4 * taken,
        take_s=8 * taken_s,
        sure=1 - 8 * lanes.estimate_error,
    )


def _root_text(root: str, lanes: LaneContext) -> str:
    if root in ("inv", "ieee"):
        return ""
    error = lanes.estimate_error
    refined = max(refined_error(root, error), 2.0**-52)
    then = "a step of third order" if root == "cubic" else f"{root[-1]} Newton"
    return f": an estimate to {error:.0e}, then {then} to {refined:.0e}"
