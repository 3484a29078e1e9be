"""How long a step may be where the table slip s passes zero, or starts from there.

docs/step-control.md derives it, with the names used here.
"""

from __future__ import annotations

from dataclasses import dataclass

from .....lowering.lane_algebra import (
    InLanes,
    Lines,
    Number,
    absolute,
    both,
    but_not,
    either,
    fma,
    given,
    larger,
    mask,
    number,
    numbers,
    power,
    rough_inverse,
    rough_rsqrt,
    select,
    smaller,
)
from .....lowering.printer import Fma
from .constants import Declared, Literal
from .lengths import AT, PLAN, PRINTER, START, TINY, TOL, Text, shorter
from .pressed import Pressed


@dataclass(frozen=True)
class PassageLines:
    """The statements of templates/ball_ball/exact/plan.j2 on s, between what branches there."""

    pushed: Text
    departs: Text
    leaves: Text
    moves: Text
    passes: Text
    grows: Text
    grows_into_sticking: Text


def passage_lines(pressed: Pressed) -> PassageLines:
    return PassageLines(
        pushed=_pushed(pressed),
        departs=_departs(pressed),
        leaves=_leaves(pressed),
        moves=_moves(),
        passes=_passes(pressed),
        grows=_grows(pressed),
        grows_into_sticking=_grows_into_sticking(pressed),
    )


def _pushed(pressed: Pressed) -> Text:
    lines = Lines(PRINTER)
    turn, per_c = numbers("turn per_c")
    lines.number("omega", InLanes(3 * pressed.k_x) * START.u_b * START.u_b * turn * per_c)
    return lines.part()


def _departs(pressed: Pressed) -> Text:
    """Does s leave zero, or run from it?"""
    lines = Lines(PRINTER)
    leaves = both(mask("counts"), either(PLAN.mask("at_rest"), number("along") >= 0))
    lines.mask("departs", but_not(leaves, PLAN.mask("runs")) if pressed.drives else leaves)
    return lines.part()


def _leaves(pressed: Pressed) -> Text:
    """The first step from rest: while s grows from nothing its direction turns with c."""
    lines = Lines(PRINTER)
    phi, l_b, omega, reach = numbers("phi l_b omega reach")
    pushes = InLanes(Fma(pressed.k_f if pressed.drives else 0, phi.form, l_b.form))
    leaving = lines.number("leaving", larger(Literal.least_leaving * phi, pushes))
    drift = lines.number("drift", select(PLAN.mask("at_rest"), l_b, leaving))
    spin = lines.number("spin", (phi + TINY) * omega)
    first = lines.number("first", Declared.depart * TOL * (drift + phi) * drift * drift)
    cubed = power(first * rough_inverse(fma(spin, spin, TINY)), 21)
    least = lines.number("least", larger(reach, cubed))
    lines.set(PLAN.h, shorter(PLAN.h, select(mask("departs"), least, PLAN.h)))
    return lines.part()


def _moves() -> Text:
    lines = Lines(PRINTER)
    lines.mask("moves", but_not(mask("counts"), PLAN.mask("at_rest")))
    return lines.part()


def _passes(pressed: Pressed) -> Text:
    """By the distance of s from zero, so that one passage costs `kPassage` tolerances."""
    lines = Lines(PRINTER)
    along, per_b, omega, miss, reach = numbers("along per_b omega miss reach")
    phi = number("phi")
    closest = lines.number("closest", -along * per_b * per_b)
    approaches = lines.mask("approaches", closest > Literal.off_rest * reach)
    within = lines.mask("within", but_not(along < 0, approaches))
    way = lines.number("way", select(approaches, closest, reach))
    curved = lines.number(
        "curved", larger(miss, Literal.curved * omega * per_b * closest * closest)
    )
    near = select(approaches, curved, miss)
    most: Number = Literal.most_passed
    if pressed.drives:
        lines.remark(
            "Its direction decides, and turns until the slip has grown: met by its length."
        )
        size = lines.number("size", select(either(within, PLAN.mask("runs")), reach, near))
        most = select(PLAN.mask("runs"), Literal.most_running, Literal.most_passed)
    else:
        size = lines.number("size", select(within, reach, near))
    room = lines.number("room", Declared.passage * TOL * rough_inverse(fma(phi, size, TINY)))
    most = lines.number("most", most)
    table = lines.number("table", Declared.table)
    bound = select(within, 1, most)
    share = lines.number("share", smaller(table * power(room, Declared.order), bound))
    length = lines.variable("length", way * share)
    lines.set(length, select(approaches, length * rough_inverse(1 + share), length))
    if pressed.drives:
        per_push = rough_inverse(fma(given(-pressed.k_f), phi, TINY))
        lines.set(length, smaller(length, Literal.most_grown_at_once * number("l_s") * per_push))
    lines.set(PLAN.h, shorter(PLAN.h, select(mask("moves"), length, PLAN.h)))
    return lines.part()


def _grows(pressed: Pressed) -> Text:
    """By what an error made before a step grows in it: the logarithm, at most."""
    lines = Lines(PRINTER)
    x, y, q, phi = numbers("end_s_x end_s_y dq_end plan.phi")
    n_1 = lines.number("n_1", fma(x, x, fma(y, y, TINY)))
    lines.number("l_1", n_1 * rough_rsqrt(n_1))
    lines.number("on_way", given(-pressed.k_f) * phi * q)
    _by_distance(lines, AT.s_x, AT.s_y, x, y, PLAN.l_s)
    lines.set(AT.grown, select(mask("keeps"), AT.grown + number("more"), AT.grown))
    return lines.part()


def _grows_into_sticking(pressed: Pressed) -> Text:
    lines = Lines(PRINTER)
    x_0, y_0, x, y, n_0, per_0, n_1, per_1, left = numbers(
        "s_x0 s_y0 s_x s_y n_0 per_0 n_1 per_1 left"
    )
    lines.number("l_1", n_1 * per_1)
    lines.number("on_way", given(-pressed.k_f) * left)
    _by_distance(lines, x_0, y_0, x, y, n_0 * per_0)
    lines.set(AT.grown, select(mask("sticks"), AT.grown + number("more"), AT.grown))
    return lines.part()


def _by_distance(lines: Lines, x_0: Number, y_0: Number, x: Number, y: Number, l_0: Number) -> None:
    """The integral of on_way/|s| over a straight path, at most, by either of two bounds.

    It is log(r)/d, r = (l + d)/(l - d), with l the sum of |s| at both ends and d the path's length.
    """
    l_1 = number("l_1")
    d_x, d_y = lines.number("d_x", x - x_0), lines.number("d_y", y - y_0)
    both_ends = lines.number("both_ends", l_0 + l_1)
    n_d = lines.number("n_d", fma(d_x, d_x, fma(d_y, d_y, TINY)))
    per_d = lines.number("per_d", rough_rsqrt(n_d))
    beyond = lines.number("beyond", both_ends + n_d * per_d)
    lines.remark("l^2 - d^2 = 2 (|s_0| |s_1| + s_0 s_1); slip that counts as none is not passed.")
    turned = select(PLAN.mask("at_rest"), 0, fma(x_0, x, y_0 * y))
    square = 2 * fma(Literal.least_length * l_0, l_1, turned)
    apart = lines.number("apart", larger(square, Literal.least_apart * beyond * beyond))
    per_apart = lines.number("per_apart", rough_inverse(apart))
    by_root = 2 * both_ends * per_apart
    by_log = per_d * fma(Literal.per_octave, power(beyond * beyond * per_apart, 1), Literal.octave)
    lines.number("grows", number("on_way") * smaller(by_root, by_log))
    lines.remark("Slip that counted as none is an error of its own size, not of a tolerance.")
    size = Literal.weighs_spin * (absolute(AT.s_x) + absolute(AT.s_y))
    less = TOL * rough_inverse(fma(smaller(number("grows"), 1), size, TINY))
    room = fma(Literal.per_octave, power(less, 1), Literal.least_octave)
    from_rest = larger(number("grows") - room + Declared.most_grown, 0)
    lines.number("more", select(PLAN.mask("at_rest"), from_rest, number("grows")))
