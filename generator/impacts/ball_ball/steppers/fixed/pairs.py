"""Two lanes of the fixed-step scheme: lanes that are the two balls, or the two slips."""

from __future__ import annotations

import re

import sympy as sp

from .....lowering.counts import OperationCounts
from .....lowering.printer import number
from .....lowering.statements import Assign, Part, lower
from ... import symbols as s
from ...contact import slips, velocity_changes
from ...reduced import reduced_system
from .parts import (
    APPROACH,
    REAL,
    SLIP_SYMBOLS,
    SPIN_SYMBOLS,
    TABLE,
    FixedStepLowering,
    approach_changes,
)


def ball_lane_slips(low: FixedStepLowering) -> Part:
    """Table slips of both balls at once, then the contact slip and the approach velocity."""
    lane = {f"{k}1{a}": sp.Symbol(f"{k}_{a}", real=True) for k in "vo" for a in "xyz"}
    item = {
        f"{k}{n}{a}": sp.Symbol(f"{k}_{a}[{n - 1}]", real=True)
        for k in "vo"
        for n in (1, 2)
        for a in "xyz"
    }
    forms = dict(slips(low.terms).items())
    in_lanes = {v: lane[v.name] for v in (*s.V1, *s.O1)}
    in_items = {v: item[v.name] for v in (*s.V1, *s.V2, *SPIN_SYMBOLS)}
    table = [
        Assign(f"s_{a}", forms[symbol].subs(in_lanes), "const Pair")
        for a, symbol in (("x", s.S1X), ("y", s.S1Y))
    ]
    contact = [
        Assign(symbol.name, forms[symbol].subs(in_items), f"const {REAL}")
        for symbol in (s.C_X, s.C_Z)
    ]
    pairs, singles = low.part(table, low.plain), low.part(contact, low.plain)
    return Part((*pairs.lines, *singles.lines), pairs.counts * 2 + singles.counts)


def pair_constants(part: Part) -> dict[str, tuple[str, str]]:
    """The pairs {a, b} that the lines of a part name, by name."""
    found = sorted({name for line in part for name in re.findall(r"pair_\w+", line)})
    return {name: _pair_values(name) for name in found if name != "pair_"}


def ball_lanes(low: FixedStepLowering) -> Part:
    """The full state's update with lane 0 = ball 1, lane 1 = ball 2."""
    changes = {v: e.subs({s.BETA1: 1, s.BETA2: 1}) for v, e in velocity_changes().items()}
    assigns, alike = [], 0
    t_x, t_y = (sp.Symbol(f"t_{a}", real=True) for a in "xy")
    for kind, first, second in (("v", s.V1, s.V2), ("o", s.O1, s.O2)):
        for index, axis in enumerate("xyz" if kind == "o" else "xy"):
            one, two = (
                sp.expand(changes[ball[index]]).subs(dict(zip(TABLE[n], (t_x, t_y), strict=True)))
                for n, ball in ((1, first), (2, second))
            )
            target = sp.Symbol(f"{kind}_{axis}", real=True)
            assigns.append(Assign(target.name, target + _lane_form(one, two, (t_x, t_y))))
            alike += _alike(one, two)
    update = low.part(low.in_order(assigns), low.lanes)
    return Part(update.lines, update.counts * 2 + _counted_twice(low, alike))


def slip_lanes(low: FixedStepLowering, pressed: int) -> Part:
    """The reduced update with lane 0 = contact slip, lane 1 = the pressed ball's slip."""
    changes = reduced_system(low.terms, pressed).changes
    x, y = SLIP_SYMBOLS[f"s{pressed}"]
    t_x, t_y = TABLE[pressed]
    assigns, alike = [], 0
    for name, lanes in (("x_lane", (s.C_X, x)), ("z_lane", (s.C_Z, y))):
        target = sp.Symbol(name, real=True)
        first, second = (changes[lane] for lane in lanes)
        assigns.append(Assign(name, target + _lane_form(first, second, (t_x, t_y))))
        alike += _alike(first, second)
    block = lower(assigns, low.lanes)
    approaches = approach_changes((pressed,)).items()
    approach = lower([*(Assign(n.name, n + c) for n, c in approaches), APPROACH], low.plain)
    before, after = (block, approach) if low.chain_first else (approach, block)
    own = block.counts * 2 + _counted_twice(low, alike)
    return Part((*before.lines, *after.lines), own + approach.counts)


def _counted_twice(low: FixedStepLowering, alike: int) -> OperationCounts:
    """To take off: products that both lanes share are made once, where no FMA holds them."""
    return OperationCounts(mul=0 if low.variant["fma"] == "fma" else -alike)


def lane_counts(low: FixedStepLowering, simd: str) -> OperationCounts:
    """Operations of what templates/ball_ball/fixed_step/*_lanes.j2 lay out around the update.

    An operation on a pair counts twice.
    """
    fused = low.variant["fma"] == "fma"
    square = OperationCounts(mul=1, fma=1) if fused else OperationCounts(mul=2, add=1)
    steps = int(low.variant["rsqrt"][-1]) if low.variant["rsqrt"].startswith("est") else 0
    newton = OperationCounts(mul=4, add=2) * steps
    root = newton + (OperationCounts(estimate=1) if steps else OperationCounts(div=1, sqrt=1))
    pair = (square + root) * 2
    if simd == "slips":  # two unit vectors, contact friction, table friction
        return pair + OperationCounts(mul=4 + 2 + 3)
    single = square + low.inverse_root("n", "c")[1]
    lift = OperationCounts(add=2 if low.terms.lift else 0)
    # contact friction, table friction of both balls, v_n
    return pair + single + lift + OperationCounts(mul=4 + 8, add=1)


def _alike(first: sp.Expr, second: sp.Expr) -> int:
    """Products of impulses between the balls that are the same in both lanes."""
    forms = sp.expand(first), sp.expand(second)
    pairs = [[form.coeff(symbol) for form in forms] for symbol in (s.DQ, s.D_X, s.D_Z)]
    return sum(a == b and a not in (-1, 0, 1) for a, b in pairs)


def _lane_form(first: sp.Expr, second: sp.Expr, table: tuple[sp.Symbol, ...]) -> sp.Expr:
    """A linear form whose coefficients are pairs: `pair_<a>_<b>` names the constant {a, b}."""
    terms = []
    for symbol in (s.DQ, s.D_X, s.D_Z, *table):
        a, b = sp.expand(first).coeff(symbol), sp.expand(second).coeff(symbol)
        if a == 0 and b == 0:
            continue
        factor = a if a == b else _pair_symbol(a, b)
        terms.append(factor * symbol)
    return sp.Add(*terms)


def _pair_values(name: str) -> tuple[str, str]:
    first, second = name.removeprefix("pair_").split("_")
    read = (sp.Rational(x.replace("m", "-").replace("o", "/")) for x in (first, second))
    one, two = (number(value) for value in read)
    return one, two


def _pair_symbol(a: sp.Expr, b: sp.Expr) -> sp.Symbol:
    text = f"pair_{a}_{b}".replace("-", "m").replace("/", "o").replace(".", "p")
    return sp.Symbol(text, real=True)
