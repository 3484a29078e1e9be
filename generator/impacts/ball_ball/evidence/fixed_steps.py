"""The verdict on a fixed-step kernel, against the same scheme in long double.

Three kinds of cases:

- Most: at most 1e-6 m/s from the scheme in long double.
- Flips: the loop ends on comparisons, so rounding may turn one by a whole step; and where the
  table slip is zero but for rounding, so is the direction of its first step. A flip is at most one
  step with e_b = 1: 1/N of the relative speed (1e-3 for N = 1000), times 1 + u_s u_b since table
  friction adds to v_n. At most 0.5 % of the cases may be flips, ties not counted: where the
  table does nothing along the line of centres every step adds the same to v_n, and for some e_b
  (0 and 1 among them) a step ends just where compression does. Then long double's rounding decides,
  not the scheme.
- Sticking contact: the fixed-step scheme chatters about zero slip, and rounding decides how. Such
  cases are compared with the exact result. They may be as far from it as the scheme in long
  double is, plus `chatter_margin`.
"""

from __future__ import annotations

import numpy as np

from ....evidence.verification.errors import SLIPS, Array, Errors, Mask
from ....evidence.verification.verdict import (
    Verdict,
    failed,
    largest_of,
    status_failure,
    worst_of,
)
from .measure import (
    EXPECTED_COLUMNS,
    MEASURE,
    OUTCOME_COLUMNS,
    STATUS,
    STICKS,
    approach_speed,
    errors_of,
    relative_speed,
)

TOLERANCE = 1e-6  # m/s
FLIP_SHARE = 0.005  # of all cases
# Where slip is vertical, chatter moves c_z by 5 (6 with lift) u_b dq a step about zero, so that |c|
# is 2.5 (3) u_b dq. Every such step rubs a ball on the table with u_s u_b dq and, with lift, lifts
# one by u_b dq. A sideways slip grows by |1 - 7/2.5| = 1.8 (|1 - 7/3| = 4/3) a step till chatter
# turns sideways and does neither any more. Where that slip is more than rounding, all roundings
# turn within a few steps of each other (seen: within 40 u_b dq, in 5,000 such cases that stick);
# where it is rounding, it may even be zero, and chatter last to the end.
CHATTER_STEPS = 32
TIE = 1e-4  # of a step
VERTICAL = 1e-9  # below this share of sideways slip its growth depends on rounding


def step_speed(cases: Array, steps: int) -> Array:
    """What one step of impulse changes a ball's speed by, dP/M = (1 + e_b) |v_n| / 2N, in m/s."""
    return (1 + cases[:, 5]) * approach_speed(cases) / (2 * steps)


def _frictions(cases: Array) -> tuple[Array, Array]:
    return cases[:, 2:4].max(axis=1), cases[:, 4]


def slips_vertically(cases: Array) -> Mask:
    """Whether the slip between the balls has no sideways part beyond rounding, at the start."""
    ball1, ball2 = cases[:, 6:15], cases[:, 15:24]
    d = ball2[:, :2] - ball1[:, :2]
    r = np.column_stack([d[:, 1], -d[:, 0]]) / np.hypot(d[:, 0], d[:, 1])[:, None]
    spin = cases[:, :1] * (ball1[:, 6:] + ball2[:, 6:])
    sideways = (r * (ball1[:, 3:5] - ball2[:, 3:5])).sum(axis=1) - spin[:, 2]
    vertical: Mask = np.abs(sideways) <= VERTICAL * np.abs((r * spin[:, :2]).sum(axis=1))
    return vertical


def chatter_margin(cases: Array, steps: int) -> Array:
    """How far two roundings of the scheme may be apart once contact sticks, in m/s.

    Two steps of v_n for the end, two of contact friction, and the steps of chatter in which one
    rounding lifts balls and rubs them on the table and the other does not: CHATTER_STEPS, or all
    where slip is vertical. A spin takes 5/2 of an impulse.
    """
    u_s, u_b = _frictions(cases)
    with np.errstate(all="ignore"):
        chatter = np.where(slips_vertically(cases), max(steps, CHATTER_STEPS), CHATTER_STEPS)
    return step_speed(cases, steps) * (2 + u_b * (5 + chatter * (1 + 2.5 * u_s)))


def ties(cases: Array, steps: int) -> Mask:
    """Whether compression ends at the end of a step: after N / (1 + e_b) of them.

    Only where table friction along the line of centres is nothing, so that v_n grows evenly:
    without friction, or where no ball is pressed since the contact does not slip vertically.
    """
    u_s, u_b = _frictions(cases)
    d = cases[:, 15:17] - cases[:, 6:8]
    spin = cases[:, 12:14] + cases[:, 21:23]
    vertical = d[:, 1] * spin[:, 0] - d[:, 0] * spin[:, 1]
    level = (vertical == 0) & (cases[:, 11] == cases[:, 20])
    with np.errstate(all="ignore"):
        turn = steps / (1 + cases[:, 5])
        tied: Mask = ((u_s * u_b == 0) | level) & (np.abs(turn - np.round(turn)) <= TIE)
    return tied


def flip_limit(cases: Array, steps: int) -> Array:
    """The largest error that a flip may make, in m/s."""
    u_s, u_b = _frictions(cases)
    return relative_speed(cases) / steps * (1 + u_s * u_b)


def euler_verdict(
    cases: Array,
    got: Array,
    euler: Array,
    exact: Array,
    steps: int,
    flip_share: float = FLIP_SHARE,
) -> Verdict:
    """`euler`: the scheme in long double with as many `steps`; `exact`: the exact result.

    Give it all cases at once: the share of flips counts over all of them. Raises KernelError if the
    tables do not fit each other.
    """
    expected = {"euler": (euler, EXPECTED_COLUMNS), "exact": (exact, EXPECTED_COLUMNS)}
    MEASURE.check_shapes(cases, got=(got, OUTCOME_COLUMNS), **expected)
    errors = errors_of(cases, got, euler)
    failure = status_failure(got, euler, errors, STATUS)
    if failure is not None:
        return failure
    loose = (euler[:, STATUS] == 0) & ((exact[:, STICKS] != SLIPS) | (euler[:, STICKS] != SLIPS))
    flipped = ~loose & ~(errors.absolute <= TOLERANCE)
    tied = int((flipped & ties(cases, steps)).sum())
    flips = tuple(int(i) for i in np.flatnonzero(flipped))
    failure = _flip_failure(cases, errors, flips, steps, flip_share, tied)
    if failure is not None:
        return failure
    from_exact = errors_of(cases, got, exact)
    failure = _chatter_failure(cases, from_exact, euler, exact, loose, steps)
    if failure is not None:
        return failure
    held = ~loose & ~flipped
    return Verdict(
        passed=True,
        reason=f"{int(held.sum())} cases within {TOLERANCE:g} m/s of the scheme, {len(flips)} "
        f"flips ({tied} of them ties), {int(loose.sum())} sticking as near the exact result as "
        "the scheme",
        max_abs_error=largest_of(errors.absolute, held),
        max_rel_error=largest_of(errors.relative, held),
        cases=len(cases),
        flips=flips,
        worst_case=worst_of(errors.relative, held),
        max_flip_error=largest_of(errors.absolute, flipped),
        sticking=int(loose.sum()),
        max_sticking_rel_error=largest_of(from_exact.relative, loose),
    )


def _flip_failure(
    cases: Array, errors: Errors, flips: tuple[int, ...], steps: int, share: float, tied: int
) -> Verdict | None:
    limit = flip_limit(cases, steps)
    for i in flips:
        if not errors.absolute[i] <= limit[i]:
            reason = f"{errors.absolute[i]:.3g} m/s from the scheme, more than {TOLERANCE:g}, and "
            return failed(f"{reason}than a step ({limit[i]:.3g})", errors, i, flips)
    if len(flips) - tied > share * len(cases):
        reason = f"one of {len(flips) - tied} flips in {len(cases)} cases, ties not counted, more "
        reason += f"than {100 * share:g} %"
        return failed(reason, errors, flips[0], flips)
    return None


def _chatter_failure(
    cases: Array, errors: Errors, euler: Array, exact: Array, loose: Mask, steps: int
) -> Verdict | None:
    own = errors_of(cases, euler, exact).absolute
    limit = own + chatter_margin(cases, steps) + TOLERANCE
    # The scheme did not end: its own distance says nothing, and the exact result is all there is.
    limit = np.where(euler[:, STICKS] > 1, relative_speed(cases) / steps + TOLERANCE, limit)
    wrong = np.flatnonzero(loose & ~((errors.absolute <= limit) & np.isfinite(errors.absolute)))
    if not len(wrong):
        return None
    i = int(wrong[0])
    reason = f"contact sticks; {errors.absolute[i]:.3g} m/s from the exact result, more than "
    return failed(f"{reason}{limit[i]:.3g}", errors, i)
