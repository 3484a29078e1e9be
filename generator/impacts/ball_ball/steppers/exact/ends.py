"""How a step ends: accepted or shrunk, at the end of compression, at the end of the collision.

docs/step-control.md derives it. Names are those of templates/ball_ball/exact/step.j2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .....lowering.lane_algebra import (
    InLanes,
    Lines,
    Number,
    Operand,
    but_not,
    call,
    fma,
    larger,
    mask,
    near_inverse,
    near_sqrt,
    number,
    numbers,
    power,
    rough_inverse,
    select,
    smaller,
    sqrt,
)
from .....lowering.printer import Group
from .constants import Declared, Literal
from .lengths import AT, PRINTER, START, TINY, TOL, Text, times
from .pressed import Pressed

H, T, V = numbers("h t v")


@dataclass(frozen=True)
class Ending:
    """What the end of a step depends on."""

    pressed: Pressed
    scalar: bool
    dense: bool  # is the end taken anywhere in a step?
    last: int  # the stage at its end
    slips: Sequence[str]
    gains: Sequence[str]  # impulses that are added up beside the slips


@dataclass(frozen=True)
class EndLines:
    """The statements of the templates, between what branches there."""

    remaining: Text
    work_since: Text
    bounce: Text
    shrinks: Text
    work: Text
    turns: Text
    nearby: Text
    kept: Text


def end_lines(of: Ending) -> EndLines:
    return EndLines(
        remaining=_remaining(of.dense),
        work_since=_work_since(of.pressed),
        bounce=_bounce(),
        shrinks=_shrinks(of.scalar),
        work=_named("dj", times(of.pressed.approach, number("j_sum"))),
        turns=_turns(of.pressed),
        nearby=_nearby(),
        kept=_kept(of),
    )


def _named(name: str, value: Number) -> Text:
    lines = Lines(PRINTER)
    lines.number(name, value)
    return lines.part()


def _remaining(dense: bool) -> Text:
    """What q remains, if table friction t_y stays: v_n^2 at the end follows from the work."""
    lines = Lines(PRINTER)
    t_y, work, target = numbers("t_y work target")
    g = lines.number("g", 2 + t_y)
    share = lines.number("share", select(mask("compressing"), START.e_b * START.e_b, 1))
    twice = lines.number("twice", fma(2 * share, work, target) * g - t_y * V * V * share)
    if dense:
        lines.remark("In full: a difference that decides where the last step ends.")
    root = sqrt if dense else near_sqrt
    lines.returns((root(larger(0.5 * twice, 0)) - V) * near_inverse(g))
    return lines.part()


def _work_since(pressed: Pressed) -> Text:
    """By parts, between the values of t_y at Radau's nodes, `mean` of them."""
    lines = Lines(PRINTER)
    moved, way, mean = numbers("moved way mean")
    of_table = -2 * H * way * mean
    if pressed.approach == 1:
        lines.returns(fma(moved, fma(-0.5, moved, V), of_table))
    else:
        form = pressed.approach
        share = lines.number("share", InLanes(Group(form) if form.is_Add else form))
        lines.returns(share * fma(moved, fma(-0.5 * share, moved, V), of_table))
    return lines.part()


def _bounce() -> Text:
    lines = Lines(PRINTER)
    share = lines.number("share", 2 * number("since") / (number("moved") + TINY))
    within = smaller(larger(share, Literal.least_share), Literal.most_share)
    lines.returns(number("target") / (1 - within))
    return lines.part()


def _shrinks(scalar: bool) -> Text:
    """The next length after a step whose error is too large."""
    lines = Lines(PRINTER)
    error = number("error") + TINY
    aimed = Declared.safe * TOL
    ratio = lines.number("ratio", aimed / error if scalar else aimed * rough_inverse(error))
    grown = Literal.shorter * power(larger(ratio, TINY), Declared.order)
    length = H * larger(Literal.reverse, grown)
    if scalar:
        lines.set(AT.h_cap, length)
    else:
        cap = lines.number("cap", length)
        lines.set(AT.h_cap, select(but_not(mask("tries"), mask("keeps")), cap, AT.h_cap))
    return lines.part()


def _turns(pressed: Pressed) -> Text:
    """What v still is there changes the work by its square, over the rate at which v grows."""
    lines = Lines(PRINTER)
    approach, v_n = pressed.approach, START.v_n
    speed = fma(2 * H, T, number("v0")) + times(approach, call("t_y", T))
    v_base = lines.number("v_base", speed)
    t_y_end = lines.number("t_y_end", times(approach, number("k_end.t_y")))
    growth = near_inverse(2 + t_y_end)
    slack = lines.number("slack", 0.5 * v_base * v_base * t_y_end * growth)
    at_turn = lines.number("at_turn", AT.work + times(approach, call("j", T)) - slack)
    lines.number("target", START.e_b * START.e_b * fma(2, at_turn, v_n * v_n))
    return lines.part()


def _nearby() -> Text:
    newton = T - 0.5 * number("off") * number("per_h")
    return _named("nearby", smaller(larger(newton, 0), 1 + 2 * Declared.extend))


def _kept(of: Ending) -> Text:
    """The state behind a step, in the lanes whose step is kept."""
    lines = Lines(PRINTER)
    after: dict[str, Operand] = {name: number(name) for name in ("rest", "work")}
    after |= {"v": number(f"v{of.last}"), "q": AT.q + number("dq_end")}
    after |= {f"gain_{n}": number(f"at.gain_{n}") + number(f"move_{n}") for n in of.gains}
    after |= {name: number(f"end_{name}") for name in of.slips}
    keeps = mask("keeps")
    for name, value in after.items():
        lines.set(number(f"at.{name}"), select(keeps, value, number(f"at.{name}")))
    lines.set(AT.k, call("select_rates", keeps, number("k_end"), AT.k))
    lines.set(AT.driven, select(keeps, 0, AT.driven))
    lines.set(AT.h_cap, select(keeps, Literal.longer * H, AT.h_cap))
    return lines.part()
