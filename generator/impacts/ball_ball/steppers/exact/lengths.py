"""How long a step may be, by the turning of the contact slip and by sticking.

docs/step-control.md derives it. Names are those of the page: c and s are the slips between the
balls and on the table, l their lengths, n their squares, per their inverses; b is the rate of s.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from .....lowering.lane_algebra import (
    Fields,
    InLanes,
    Lines,
    Mask,
    Number,
    absolute,
    both,
    but_not,
    call,
    constant,
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
from .....lowering.printer import ExpressionPrinter, Group
from .constants import Declared, Literal
from .pressed import Pressed

Text = tuple[str, ...]
AT, START, PLAN = Fields("at"), Fields("start"), Fields("plan")
TOL = AT.tolerance
TINY = Declared.tiny_square
FLOAT_ROUNDING = constant("0x1p-23")
PRINTER = ExpressionPrinter(True, fma_name="fma", number_format="real({})")


def times(share: sp.Expr, value: Number) -> Number:
    """share * value, and no product where the share is one."""
    if share == 1:
        return value
    return InLanes(Group(share) if share.is_Add else share) * value


@dataclass(frozen=True)
class PlanLines:
    """The statements of templates/ball_ball/exact/plan.j2, between what branches there."""

    slips: Text
    at_rest: Text
    drive: Text
    settles: Text
    driven: Text
    drift: Text
    passing: Text
    remains: Text
    sticking: Text
    settled: Text
    lengths: Text
    shortest: Text
    account: Text
    capped: Text
    halves: Text
    halved: Text
    over: Text
    spends: Text
    spends_in_lanes: Text


def plan_lines(pressed: Pressed, drift: Text, floats: bool) -> PlanLines:
    """What the next iteration does; `drift` declares b_x and b_y."""
    return PlanLines(
        slips=_slips(pressed),
        at_rest=_at_rest(),
        drive=_drive(pressed),
        settles=_settles(),
        driven=_driven(),
        drift=drift,
        passing=_passing(),
        remains=_remains(pressed, floats),
        sticking=_sticking(pressed),
        settled=_settled(),
        lengths=_lengths(pressed),
        shortest=_set(PLAN.h, shorter(AT.rest, PLAN.step_c)),
        account=_masks(counts=number("phi") * PLAN.h > Declared.counts * TOL),
        capped=_set(PLAN.h, shorter(PLAN.h, AT.h_cap)),
        halves=_masks(halves=both(PLAN.h < AT.rest, 2 * PLAN.h > AT.rest)),
        halved=_set(PLAN.h, select(mask("halves"), 0.5 * AT.rest, PLAN.h)),
        over=_over(),
        spends=_spends(),
        spends_in_lanes=_spends_in_lanes(),
    )


def shorter(h: Number, bound: Number) -> Number:
    return call("shorter", h, bound)


def _set(target: Number, value: Number) -> Text:
    lines = Lines(PRINTER)
    lines.set(target, value)
    return lines.part()


def _masks(**masks: Mask) -> Text:
    lines = Lines(PRINTER)
    for name, value in masks.items():
        lines.mask(name, value)
    return lines.part()


def _over() -> Text:
    lines = Lines(PRINTER)
    h = select(PLAN.mask("goes_on"), PLAN.h, 1)
    lines.set(PLAN.h, h, "those that are over make no step, nor trap")
    return lines.part()


def _slips(pressed: Pressed) -> Text:
    lines = Lines(PRINTER)
    n_c = lines.number("n_c", fma(AT.c_x, AT.c_x, fma(AT.c_z, AT.c_z, TINY)))
    n_s = lines.number("n_s", fma(AT.s_x, AT.s_x, fma(AT.s_y, AT.s_y, TINY)))
    per_c = lines.number("per_c", rough_rsqrt(n_c))
    lines.number("l_c", n_c * per_c)
    per_s = lines.number("per_s", rough_rsqrt(n_s))
    lines.number("l_s", n_s * per_s)
    lines.number("phi", -START.u_s * START.u_b * per_c * AT.c_z)
    lines.set(PLAN.l_c, number("l_c"))
    if pressed.drives:
        lines.set(PLAN.l_s, number("l_s"))
        lines.set(PLAN.phi, number("phi"))
    return lines.part()


def _at_rest() -> Text:
    lines = Lines(PRINTER)
    phi, l_s = numbers("phi l_s")
    lines.set(PLAN.mask("at_rest"), phi * l_s <= Declared.rest * TOL)
    return lines.part()


def _settles() -> Text:
    """Slip that counts as none is taken away where it is small itself.

    Not from a smooth table, which slip moves nothing on: momentum stays what it was to rounding.
    """
    lines = Lines(PRINTER)
    small = both(number("l_s") <= Declared.settled * TOL, START.u_s > 0)
    lines.mask("settles", both(mask("stops"), small))
    for slip in (AT.s_x, AT.s_y):
        lines.set(slip, select(mask("settles"), 0, slip))
    return lines.part()


def _spends() -> Text:
    """Errors add up: what a step was off by is no longer there for the next."""
    least = Declared.least_tolerance * START.tolerance
    return _set(TOL, larger(fma(given(-Declared.spent.form), number("error"), TOL), least))


def _spends_in_lanes() -> Text:
    """Without a least: what takes so many steps is left to one lane."""
    left = fma(given(-Declared.spent.form), number("error"), TOL)
    return _set(TOL, select(mask("keeps"), left, TOL))


def _drive(pressed: Pressed) -> Text:
    """Where the table drives the slip harder than all else, it matters which way it points."""
    lines = Lines(PRINTER)
    per_c, phi, n_s = numbers("per_c phi n_s")
    rubbed = lines.number("rubbed", -START.u_b * per_c)
    d_x = lines.number("d_x", rubbed * AT.c_x)
    d_z = lines.number("d_z", rubbed * AT.c_z)
    x = lines.number("drive_x", pressed.drift_x(d_x))
    y = lines.number("drive_y", pressed.drift_y(d_z))
    push = lines.number("push", given(-pressed.k_f * Literal.beats.form) * phi)
    beats = lines.mask("beats", push * push > fma(x, x, y * y))
    lines.set(PLAN.mask("runs"), both(beats, n_s > 2 * TINY))
    lines.set(PLAN.mask("at_rest"), but_not(PLAN.mask("at_rest"), PLAN.mask("runs")))
    return lines.part()


def _driven() -> Text:
    return _set(AT.driven, select(PLAN.mask("at_rest"), 1, 0))


def _passing() -> Text:
    """The path of s if b stays: how near it passes zero, and how far away that is."""
    lines = Lines(PRINTER)
    b_x, b_y, l_s, per_s = numbers("b_x b_y l_s per_s")
    n_b = lines.number("n_b", fma(b_x, b_x, fma(b_y, b_y, TINY)))
    per_b = lines.number("per_b", rough_rsqrt(n_b))
    l_b = lines.number("l_b", n_b * per_b)
    lines.number("along", fma(AT.s_x, b_x, AT.s_y * b_y))
    miss = lines.number(
        "miss",
        absolute(fma(AT.s_x, b_y, -AT.s_y * b_x)) * per_b * per_b,
        "q: closest approach of s to zero",
    )
    lines.number("reach", l_s * per_b, "q: |s| / |b|")
    lines.number("bend", smaller(1, miss * l_b * per_s))
    return lines.part()


def _until_end(pressed: Pressed) -> Number:
    """How fast v_n rises with q."""
    return 2 + times(pressed.approach, number("at.k.t_y"))


def _remains(pressed: Pressed, floats: bool) -> Text:
    lines = Lines(PRINTER)
    if floats:
        over = AT.rest > FLOAT_ROUNDING * AT.q
        lines.set(PLAN.mask("goes_on"), over, "less is rounding, and might never end")
    else:
        lines.set(PLAN.mask("goes_on"), AT.rest > 0)
    lines.number("phase", select(AT.v < 0, -AT.v, AT.rest * _until_end(pressed)))
    return lines.part()


def _sticking(pressed: Pressed) -> Text:
    """l_stick: the q in which contact sticks, if s keeps its direction."""
    lines = Lines(PRINTER)
    n_c, l_c, per_s, phase = numbers("n_c l_c per_s phase")
    k_z = lines.number("k_z", given(pressed.k_z) - given(pressed.k_zt) * START.u_s * AT.s_y * per_s)
    falls = fma(given(pressed.k_x) * AT.c_x, AT.c_x, fma(k_z * AT.c_z, AT.c_z, TINY))
    l_stick = lines.number("l_stick", n_c * l_c * START.per_u_b * rough_inverse(falls))
    left = lines.number(
        "left",
        pressed.ratio(pressed.k_zt, pressed.k_z) * START.u_s * absolute(AT.c_z),
        "what table friction can still do",
    )
    in_time = both(l_stick * _until_end(pressed) < phase, l_c < AT.tail_cap)
    lines.set(PLAN.mask("sticks"), both(PLAN.mask("goes_on"), in_time))
    lines.mask("matters", both(PLAN.mask("sticks"), left > Declared.counts * TOL))
    return lines.part()


def _settled() -> Text:
    """May a step into sticking ignore where s passes? Not where it passes on the way."""
    lines = Lines(PRINTER)
    left, bend, l_stick, reach, along, n_b = numbers("left bend l_stick reach along n_b")
    room = lines.number("room", power(TOL * rough_inverse(fma(left, bend, TINY)), 8))
    away = lines.mask("away", l_stick <= Literal.away * reach * room)
    towards = lines.mask("towards", -along >= Literal.towards * l_stick * n_b)
    settled = lines.mask("settled", either(both(along < 0, towards), both(along >= 0, away)))
    lines.set(PLAN.mask("sticks"), but_not(PLAN.mask("sticks"), but_not(mask("matters"), settled)))
    return lines.part()


def _lengths(pressed: Pressed) -> Text:
    """By the turning of the contact slip."""
    lines = Lines(PRINTER)
    per_c, l_c, l_stick = numbers("per_c l_c l_stick")
    by_table = pressed.ratio(pressed.k_zt, pressed.k_x) * START.u_s * absolute(AT.c_z)
    by_contact = pressed.ratio(pressed.k_x - pressed.k_z, pressed.k_x) * absolute(AT.c_x * AT.c_z)
    turn = lines.number("turn", fma(by_contact, per_c * per_c, fma(by_table, per_c, TINY)))
    aimed = Declared.safe * pressed.k_x * TOL * per_c * rough_inverse(turn)
    by_turning = Declared.turn / pressed.k_x * l_c * START.per_u_b * power(aimed, Declared.order)
    lines.set(PLAN.step_c, smaller(Declared.reach * l_stick, by_turning))
    return lines.part()
