"""Which collisions surely stick, and for which of them so many steps to c = 0 do (sticking.py)."""

from __future__ import annotations

import sympy as sp

from .....lowering.lane_algebra import (
    Fields,
    Lines,
    Mask,
    Number,
    absolute,
    both,
    constant,
    fma,
    given,
    larger,
    mask,
    near_inverse,
    near_sqrt,
    number,
    rough_inverse,
    rough_rsqrt,
    select,
)
from ..exact.pressed import Pressed
from .bounds import Sticks, StickWeights
from .whole import PRINTER, Text

TINY = constant("kTinySquare")
SURELY = 1.01  # of the bound: estimates of roots may be off by 0.4 %
_END = Fields("end")


def surely(sticks: Sticks, pressed: Pressed) -> Text:
    """Masks `stick1`, `stick2`: does contact stick in compression, and do so many steps do for it?

    `stick3`: does it stick before the end, and do two steps with v_n = 0 somewhere within them?

    From `slips`, `approach_1`, `u_b`, `u_s`, `near` and `relative`, as `certificate` has them.
    """
    lines, slips = Lines(PRINTER), Fields("slips")
    u_b, u_s = number("u_b"), number("u_s")
    c_x, c_z = slips.c_x, slips.c_z
    lines.number("size", absolute(c_z))
    lines.remark("The slips fall at least as exp(-k_x w) and exp(-slowest w), dw = u_b dq / |c|")
    slowest = lines.number("slowest", given(pressed.k_z) - given(pressed.k_zt) * u_s)
    left = lines.number("left", u_s * number("size") * near_inverse(slowest))
    falls = lines.number("falls", fall_of(pressed, c_x, c_z, slowest))
    latest = fma(given(pressed.k_xt / pressed.k_x), left, SURELY * falls)
    latest = lines.number("latest", 2 * latest)
    lasts = fma(-abs(pressed.approach), left, number("approach_1"))
    lines.mask("early", latest < u_b * lasts)
    lines.remark("v_n at the end is at least e_b V - 2 left / e_b")
    most = fma(-2 * sticks.chord[1], _END.bounce, 1 + 2 * sticks.chord[0])
    ends = fma(_END.bounce, number("approach_1"), number("approach_1"))
    at_all = latest < u_b * fma(-abs(pressed.approach) * most, left, ends)
    lines.mask("bounces", both(at_all, _END.bounce >= sticks.least_e_b))
    _path(lines, pressed)
    friction = lines.number("friction", u_s * u_b)
    within = both(u_b <= sticks.most_u_b, u_s <= sticks.most_u_s)
    lines.mask("known", both(within, friction <= sticks.most_friction))
    lines.number("room", sticks.error * number("relative"))
    per_c = rough_rsqrt(fma(c_x, c_x, fma(c_z, c_z, TINY)))
    lines.number("n_x", absolute(c_x) * per_c)
    lines.number("rubs", u_s * number("size"))
    for i, weights in enumerate((sticks.one, sticks.two), 1):
        lines.number(f"near_{i}", select(number("near") <= 0, 0, _nearest(lines, sticks, i)))
        lines.mask(f"stick{i}", both(mask("early"), _does(lines, sticks, weights, i)))
    lines.remark("What is missed of J_c counts by 1 - e_b^2")
    lines.number("lost", -0.5 * _END.kept)
    lines.mask("stick3", both(mask("bounces"), _does(lines, sticks, sticks.bouncing, 2)))
    return lines.part()


def fall_of(pressed: Pressed, c_x: Number, c_z: Number, k: Number | sp.Expr) -> Number:
    """The most u_b q until c = 0, or nearly that: Schwarz's inequality (docs/step-control.md)."""
    k_x = given(pressed.k_x)
    if isinstance(k, Number):
        product = k_x * k
        squares = fma(c_x * k, c_x * k, (k_x * c_z) * (k_x * c_z))
        return 0.5 * (k_x + k) * near_sqrt(squares * near_inverse(product * product * product))
    squares = fma(c_x * c_x, given(k**2), given(pressed.k_x**2) * (c_z * c_z))
    square = given((pressed.k_x + k) ** 2 / (4 * (pressed.k_x * k) ** 3)) * squares
    return near_sqrt(square)


def _path(lines: Lines, pressed: Pressed) -> None:
    """The straight path of s to where it sticks: b, and the lengths |s| at its ends."""
    slips = Fields("slips")
    usual = fall_of(pressed, slips.c_x, slips.c_z, pressed.k_z)
    lines.number("q_stuck", usual * rough_inverse(number("u_b")))
    lines.number("b_x", given(pressed.recoil / pressed.k_x) * slips.c_x)
    driven = given(pressed.k_b / pressed.k_z) * number("size")
    lines.number("b_y", fma(given(pressed.drive), number("q_stuck"), driven))
    lines.number("l_b", _length(number("b_x"), number("b_y")))
    lines.number("l_0", _length(slips.s_x, slips.s_y))
    lines.number("l_1", _length(slips.s_x + number("b_x"), slips.s_y + number("b_y")))


def _length(x: Number, y: Number) -> Number:
    square = fma(x, x, fma(y, y, TINY))
    return square * rough_rsqrt(square)


def _nearest(lines: Lines, sticks: Sticks, steps: int) -> Number:
    """How near zero the table slip passes in the worst of the steps; see certificate.py."""
    l_b, l_0, l_1 = number("l_b"), number("l_0"), number("l_1")
    if steps == 1:
        return l_b * rough_inverse(l_0 + l_1)
    share = 1 - sticks.cut**2
    slips, b_x, b_y = Fields("slips"), number("b_x"), number("b_y")
    l_m = lines.number("l_m", _length(fma(share, b_x, slips.s_x), fma(share, b_y, slips.s_y)))
    first = share * l_b * rough_inverse(l_0 + l_m)
    return larger(first, sticks.cut**2 * l_b * rough_inverse(l_m + l_1))


def _does(lines: Lines, sticks: Sticks, weights: StickWeights, i: int) -> Mask:
    near, u_s, n_x, friction = (number(n) for n in (f"near_{i}", "u_s", "n_x", "friction"))
    square = near * near
    cube = square * near
    bends, rubs = weights.bends * u_s, fma(weights.rubs_s, u_s, weights.rubs_b * number("u_b"))
    if weights.work_passes:
        bends = fma(weights.work_passes, number("lost"), bends)
        rubs = fma(weights.work_rubs, number("lost"), rubs)
    passes = cube * fma(weights.passes, cube, bends)
    turns = n_x * fma(weights.turns, square, friction * rubs)
    off = number("rubs") * (passes + turns)
    return both(both(mask("known"), near < sticks.most_near), off < number("room"))
