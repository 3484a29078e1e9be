"""The step into sticking: its rates, what it may be off, and whether contact surely sticks in it.

docs/step-control.md derives it. Names are those of templates/ball_ball/exact/sticking.j2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

from .....lowering.lane_algebra import (
    Fields,
    Fixed,
    InLanes,
    Lines,
    Number,
    Operand,
    absolute,
    both,
    but_not,
    call,
    constant,
    fma,
    given,
    larger,
    mask,
    near_sqrt,
    number,
    numbers,
    power,
    rough_inverse,
    rough_rsqrt,
    rsqrt,
    select,
    smaller,
    sqrt,
)
from .....lowering.printer import Fma, Group
from .constants import Declared, Literal
from .lengths import AT, PLAN, PRINTER, START, TINY, TOL, Text, times
from .pressed import Pressed

SO_FAR, END, OUT = Fields("so_far"), Fields("end"), Fields("out.k")
T_X, T_Y, D_X, D_Z = numbers("t_tail_x t_tail_y d_tail_x d_tail_z")
S_X0, S_Y0, DQ = numbers("s_x0 s_y0 dq")


@dataclass(frozen=True)
class Sticking:
    """What the step into sticking depends on."""

    pressed: Pressed
    divides: bool  # are roots taken, and divided by?
    power: int  # of the steepness in what nodes can miss (ellipse.py)
    gains: Sequence[str]  # impulses that are added up beside the slips


@dataclass(frozen=True)
class StickingLines:
    """The statements of templates/ball_ball/exact/sticking.j2, between what branches there."""

    falls: Text
    rates: Text
    out: Text
    starts: Text
    contact: Text
    stuck: Text
    ends: Text
    error: Text
    surely: Text
    capped: Text
    moves: Text
    done: Text


def sticking_lines(of: Sticking) -> StickingLines:
    pressed = of.pressed
    s_x, s_y = _moved(pressed)
    return StickingLines(
        falls=_falls(),
        rates=_rates(of),
        out=_out(of),
        starts=_starts(),
        contact=_contact(pressed, times(pressed.k_xt, T_X), -AT.c_z),
        stuck=_set(s_x=S_X0 + s_x, s_y=S_Y0 + s_y),
        ends=_ends(pressed),
        error=_error(of),
        surely=_surely(pressed),
        capped=_capped(),
        moves=_moves(pressed),
        done=_done(of),
    )


def steepness_lines() -> Text:
    """1 / P of docs/step-control.md, of a way of length d between slips of lengths l in all."""
    lines = Lines(PRINTER)
    d_x, d_y = number("s1_x") - number("s0_x"), number("s1_y") - number("s0_y")
    way = lines.number("way", fma(d_x, d_x, InLanes(Group(d_y.form)) * d_y))
    both_ends = lines.number("sum", number("l0") + number("l1"))
    lines.returns(way * rough_inverse(fma(4 * both_ends, both_ends, -3 * way) + TINY))
    return lines.part()


def _set(**values: Number) -> Text:
    lines = Lines(PRINTER)
    for name, value in values.items():
        lines.set(number(name), value)
    return lines.part()


def _falls() -> Text:
    lines = Lines(PRINTER)
    lines.number("c_z", AT.c_z * (constant("left") * constant("left")))
    return lines.part()


def _contact(pressed: Pressed, c_x: Number, c_z: Number) -> Text:
    """Contact impulses that, beside table friction, bring the slips to c_x and by c_z."""
    lines = Lines(PRINTER)
    lines.number("d_tail_x", (c_x - AT.c_x) * given(1 / pressed.k_x))
    lines.number("d_tail_z", (c_z - given(pressed.k_zt) * T_Y) * given(1 / pressed.k_z))
    return lines.part()


def _moved(pressed: Pressed) -> tuple[Number, Number]:
    """How far s is from where it was, by the impulses so far."""
    x = InLanes(Fma(pressed.k_f, T_X.form, -pressed.recoil * D_X.form))
    driven = Fma(pressed.k_b, D_Z.form, pressed.drive * DQ.form)
    return x, InLanes(Fma(pressed.k_f, T_Y.form, driven))


def _rates(of: Sticking) -> Text:
    pressed, lines = of.pressed, Lines(PRINTER)
    left, bent, u_s = constant("left"), constant("bent"), START.u_s
    c_z = number("c_z")
    r = lines.number("r", SO_FAR.r * bent)
    lines.extend(_contact(pressed, fma(r, c_z, times(pressed.k_xt, T_X)), c_z - AT.c_z))
    x, y = _moved(pressed)
    s_x, s_y = lines.number("s_x", S_X0 + x), lines.number("s_y", S_Y0 + y)
    i_s = lines.number("i_s", rsqrt(fma(s_x, s_x, fma(s_y, s_y, TINY))))
    lines.number("u_x", s_x * i_s)
    u_y = lines.number("u_y", s_y * i_s)
    k_z = lines.number("k_z", given(pressed.k_z) - given(pressed.k_zt) * u_s * u_y)
    if of.divides:
        scale = lines.number("scale", 2 / left / k_z)
    else:
        root = lines.number("root", rsqrt(k_z))
        scale = lines.number("scale", 2 / left * root * root)
    lines.number("pull", u_s * c_z * scale, "negative")
    lines.number("n_r", fma(r, r, 1))
    return lines.part()


def _out(of: Sticking) -> Text:
    pressed, lines = of.pressed, Lines(PRINTER)
    c_z, u_x, u_y, scale, pull, n_r = numbers("c_z u_x u_y scale pull n_r")
    length = sqrt(n_r) if of.divides else n_r * rsqrt(n_r)
    lines.set(OUT.x, pull * u_x)
    lines.set(OUT.y, pull * u_y)
    lines.set(OUT.q, -InLanes(Group(length.form)) * c_z * scale * START.per_u_b)
    bending = pressed.ratio(pressed.k_x * pressed.k_zt, pressed.k_z) * u_y
    turned = fma(bending, SO_FAR.r, Fixed(pressed.k_xt) / constant("bent") * u_x)
    lines.set(OUT.r, -scale * START.u_s * turned)
    lines.set(number("out.v"), AT.v + 2 * DQ + times(pressed.approach, T_Y))
    return lines.part()


def _starts() -> Text:
    """Slip that counts as none starts where it is driven to."""
    lines = Lines(PRINTER)
    for start, rate, slip in ((S_X0, "b_x", AT.s_x), (S_Y0, "b_y", AT.s_y)):
        driven = number(rate) * Declared.tiny_slip
        lines.number(start.form.name, select(PLAN.mask("at_rest"), driven, slip))
    lines.mask("compressing", AT.v < 0)
    lines.number("r_0", AT.c_x / AT.c_z)
    return lines.part()


def _error(of: Sticking) -> Text:
    """By the embedded method, but no smaller than what its nodes can miss of the turning of s."""
    pressed, lines = of.pressed, Lines(PRINTER)
    e_x, e_y, e_q, s_x, s_y = numbers("e_x e_y e_q s_x s_y")
    n_0 = lines.number("n_0", fma(S_X0, S_X0, fma(S_Y0, S_Y0, TINY)))
    n_1 = lines.number("n_1", fma(s_x, s_x, fma(s_y, s_y, TINY)))
    per_0 = lines.number("per_0", rough_rsqrt(n_0))
    per_1 = lines.number("per_1", rough_rsqrt(n_1))
    lines.remark(
        "An error of q moves s along y, and so turns it by |s_x|/s^2: the more of both ends."
    )
    turn_1 = lines.number("turn_1", absolute(s_x) * per_1 * per_1)
    turn_0 = select(PLAN.mask("at_rest"), 0, absolute(S_X0) * per_0 * per_0)
    turns = lines.number("turns", times(pressed.drive, larger(turn_0, turn_1)))
    left = pressed.ratio(pressed.k_zt, pressed.k_z) * START.u_s * absolute(AT.c_z)
    turned = lines.number("turned", Literal.settles_near * left * turns)
    lines.remark(
        "An error of q shifts the work of table friction against v_n, and with it v_n at the end."
    )
    work = lines.number("work_error", 0.5 * absolute(e_q * END.y / START.v_n))
    impulses = Literal.weighs_spin * larger(absolute(e_x), absolute(e_y))
    seen = fma(turned, absolute(e_q), impulses) + work
    estimate = lines.number("estimate", Declared.tail * seen)
    lines.remark("Nor is it smaller than what nodes so far apart can miss of the turning of s.")
    passed = call("steepness", S_X0, S_Y0, n_0 * per_0, s_x, s_y, n_1 * per_1)
    steep = lines.number("steep", passed)
    most = Declared.tail_unseen * START.u_s * absolute(AT.c_z)
    missed = most * reduce(lambda a, b: a * b, [steep] * of.power)
    unseen = lines.number("unseen", select(PLAN.mask("at_rest"), 0, missed))
    lines.number("error", larger(larger(estimate, unseen), _work_missed(pressed, lines)))
    return lines.part()


def _work_missed(pressed: Pressed, lines: Lines) -> Number:
    """What q at the end is off by for the work: one of two embedded errors shows it."""
    e_q, e_j, v_last = numbers("e_q e_j v_last")
    lines.remark(
        "Twice what the work is off by is what v_n^2 at the end is: over v_n, what 2 q is."
    )
    both_errors = fma(2 * absolute(END.y), absolute(e_q), absolute(e_j))
    by_work = absolute(times(pressed.approach, both_errors))
    share = select(mask("compressing"), START.e_b * START.e_b, 1)
    per_v = lines.number("per_v", share * rough_inverse(v_last + TOL))
    return lines.number("work_missed", Declared.tail_work * by_work * per_v)


def _ends(pressed: Pressed) -> Text:
    """v_n at the end, and at the end of this phase."""
    lines = Lines(PRINTER)
    compressing, e_b, v_n = mask("compressing"), START.e_b, START.v_n
    work = lines.number("work", AT.work + times(pressed.approach, number("dj")))
    bounced = e_b * e_b * fma(v_n, v_n, 2 * work)
    square = lines.number("square", select(compressing, bounced, fma(2, work, AT.target)))
    v_last = lines.number("v_last", sqrt(larger(square, 0)))
    lines.number("limit", select(compressing, 0, v_last))
    return lines.part()


def _surely(pressed: Pressed) -> Text:
    """Does it surely stick before the end? The template says why at the latest at `latest`."""
    lines = Lines(PRINTER)
    k_x, k_z, u_s = given(pressed.k_x), given(pressed.k_z), START.u_s
    least = float(Literal.least_fall.form) * pressed.least_k_z
    slowest = lines.number("slowest", larger(k_z - given(pressed.k_zt) * u_s, least))
    left = lines.number("left", u_s * absolute(AT.c_z) * rough_inverse(slowest))
    twice = given(2 * pressed.k_x)
    m = lines.number("m", twice * slowest * rough_inverse(k_x + slowest))
    falls_x = lines.number("falls_x", AT.c_x * AT.c_x * rough_inverse(twice - m))
    falls_z = lines.number("falls_z", AT.c_z * AT.c_z * rough_inverse(fma(2, slowest, -m)))
    falls = lines.number("falls", near_sqrt((falls_x + falls_z) * rough_inverse(m)))
    by_table = pressed.ratio(pressed.k_xt, pressed.k_x)
    latest = lines.number("latest", fma(by_table, left, Literal.margin * falls) * START.per_u_b)
    v = AT.v + 2 * latest + absolute(times(pressed.approach, left))
    v_stuck = lines.number("v_stuck", v)
    there = PLAN.l_c > Declared.gone * TOL
    late = lines.mask("late", both(there, v_stuck > number("limit")))
    fits = number("error") <= Declared.safe * TOL
    lines.mask("sticks", but_not(both(mask("tries"), fits), late))
    return lines.part()


def _capped() -> Text:
    lines = Lines(PRINTER)
    ratio = lines.number("ratio", Declared.safe * TOL / (number("error") + TINY))
    share = larger(Literal.reverse, smaller(Literal.half_slip, power(ratio, Declared.order)))
    cap = lines.number("cap", PLAN.l_c * share)
    lines.set(AT.tail_cap, select(mask("tries"), cap, AT.tail_cap))
    return lines.part()


def _moves(pressed: Pressed) -> Text:
    lines = Lines(PRINTER)
    rise = number("v_last") - AT.v - times(pressed.approach, T_Y)
    lines.number("dq", 0.5 * rise)
    for name, value in zip(("move_s_x", "move_s_y"), _moved(pressed), strict=True):
        lines.number(name, value)
    return lines.part()


def _done(of: Sticking) -> Text:
    lines = Lines(PRINTER)
    sticks = mask("sticks")
    moves = {f"gain_{name}": number(name.replace("_", "_tail_")) for name in of.gains}
    after: dict[str, Operand] = {}
    after |= {name: number(f"at.{name}") + move for name, move in {"q": DQ, **moves}.items()}
    after |= {"c_x": 0, "c_z": 0}
    after |= {name: number(f"at.{name}") + number(f"move_{name}") for name in ("s_x", "s_y")}
    for name, value in after.items():
        lines.set(number(f"at.{name}"), select(sticks, value, number(f"at.{name}")))
    return lines.part()
