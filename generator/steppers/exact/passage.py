"""How long a step may be where the table slip s passes zero, or starts from there.

docs/step-control.md derives it, with the names used here.
"""

from __future__ import annotations

from dataclasses import dataclass

from ...lowering.lane_algebra import (
    InLanes,
    Lines,
    Number,
    both,
    but_not,
    call,
    either,
    fma,
    given,
    larger,
    mask,
    number,
    numbers,
    power,
    rough_inverse,
    select,
    smaller,
)
from ...lowering.printer import Fma
from .constants import Declared, Growth, Literal
from .lengths import PLAN, PRINTER, START, TINY, TOL, Text, shorter
from .pressed import Pressed


@dataclass(frozen=True)
class PassageLines:
    """The statements of templates/exact/plan.j2 on s, between what branches there."""

    growth: Text
    pushed: Text
    strongly: Text
    departs: Text
    leaves: Text
    moves: Text
    passes: Text


def passage_lines(pressed: Pressed) -> PassageLines:
    return PassageLines(
        growth=_growth(),
        pushed=_pushed(pressed),
        strongly=_strongly(),
        departs=_departs(pressed),
        leaves=_leaves(pressed),
        moves=_moves(),
        passes=_passes(pressed),
    )


def _growth() -> Text:
    """By how much an error near zero slip grows until the slip is `large`: r, its root, ..."""
    lines = Lines(PRINTER)
    push, drift, size, large = numbers("push drift size large")
    r = lines.number("ratio", larger(1, large * rough_inverse(size + TINY)))
    less = lines.number("less", select(push > Growth.little * drift, power(r, 16), power(r, 8)))
    more = lines.number("more", select(push > Growth.much * drift, r, power(r, 32)))
    lines.returns(select(push > Growth.some * drift, more, less))
    return lines.part()


def growth(push: Number, drift: Number, size: Number, large: Number) -> Number:
    return call("growth", push, drift, size, large)


def _pushed(pressed: Pressed) -> Text:
    lines = Lines(PRINTER)
    turn, per_c, phi, l_b = numbers("turn per_c phi l_b")
    lines.number("omega", InLanes(3 * pressed.k_x) * START.u_b * START.u_b * turn * per_c)
    if pressed.drives:
        push = lines.number("push", given(-pressed.k_f) * phi)
        lines.mask("strong", both(mask("counts"), push > Literal.strongly * l_b))
    return lines.part()


def _strongly() -> Text:
    lines = Lines(PRINTER)
    short = smaller(PLAN.h, Declared.strong * PLAN.step_c)
    lines.set(PLAN.h, select(mask("strong"), short, PLAN.h))
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
    phi, l_b, omega, push, reach, rest = numbers("phi l_b omega push reach rest")
    pushes = InLanes(Fma(pressed.k_f if pressed.drives else 0, phi.form, l_b.form))
    leaving = lines.number("leaving", larger(Literal.least_leaving * phi, pushes))
    drift = lines.number("drift", select(PLAN.mask("at_rest"), l_b, leaving))
    spin = lines.number("spin", (phi + TINY) * omega)
    room = Declared.depart * TOL * (drift + phi) * drift * drift
    if pressed.drives:
        size = l_b * reach + Declared.tolerance
        grows = lines.number("grows", growth(push, drift, size, l_b * rest))
        room = room * rough_inverse(grows)
    first = lines.number("first", room)
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
    push, l_b, rest, phi = numbers("push l_b rest phi")
    closest = lines.number("closest", -along * per_b * per_b)
    approaches = lines.mask("approaches", closest > Literal.off_rest * reach)
    within = lines.mask("within", but_not(along < 0, approaches))
    way = lines.number("way", select(approaches, closest, reach))
    curved = lines.number(
        "curved", larger(miss, Literal.curved * omega * per_b * closest * closest)
    )
    near = select(approaches, curved, miss)
    most: Number = Literal.most_passed
    table: Number = Declared.table
    if pressed.drives:
        lines.remark(
            "Its direction decides, and turns until the slip has grown: met by its length."
        )
        size = lines.number("size", select(either(within, PLAN.mask("runs")), reach, near))
        swell = lines.number("swell", size * growth(push, l_b, size, rest))
        most = select(PLAN.mask("runs"), Literal.most_running, Literal.most_passed)
        table = select(mask("strong"), Declared.strong * Declared.table, Declared.table)
    else:
        swell = lines.number("size", select(within, reach, near))
    room = lines.number("room", Declared.passage * TOL * rough_inverse(fma(phi, swell, TINY)))
    most = lines.number("most", most)
    table = lines.number("table", table)
    bound = select(within, 1, most)
    share = lines.number("share", smaller(table * power(room, Declared.order), bound))
    length = lines.variable("length", way * share)
    lines.set(length, select(approaches, length * rough_inverse(1 + share), length))
    lines.set(PLAN.h, shorter(PLAN.h, select(mask("moves"), length, PLAN.h)))
    return lines.part()
