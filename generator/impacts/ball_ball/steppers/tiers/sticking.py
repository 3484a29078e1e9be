"""Fixed steps to where contact sticks, c = 0, and which collisions surely stick so.

The unknowns run over y, from 1 to 0: c_z is y^2 of what it was, so that c = 0 is where the way
ends, and not somewhere within a step. Impulses of contact follow from the linear relations. Where
table friction keeps its direction, c_x / c_z = r y^bend + star with a constant r, whose rate is
therefore small; and an error of anything is weighed by table friction, since without it all is
known (docs/fixed-tiers.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
    numbers,
    rough_inverse,
    rough_rsqrt,
    rsqrt,
    select,
    sqrt,
)
from .....tableaus.plain import PlainTableau
from .....tableaus.tableau import Row
from ..exact.lengths import times
from ..exact.pressed import Pressed
from .bounds import Sticks, StickWeights
from .crossing import work_after
from .whole import PRINTER, Text

TINY = constant("kTinySquare")
SURELY = 1.01  # of the bound: estimates of roots may be off by 0.4 %
LEAST_APART = 0.3  # k_x - k_z of `star`, where they nearly balance
TERMS = 8  # of a polynomial for a power
SUMS = ("t_x", "t_y", "q", "r")
_ON, _END = Fields("on"), Fields("end")


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
    falls = lines.number("falls", _falls(pressed, c_x, c_z, slowest))
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


def _falls(pressed: Pressed, c_x: Number, c_z: Number, k: Number | sp.Expr) -> Number:
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
    usual = _falls(pressed, slips.c_x, slips.c_z, pressed.k_z)
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


def begin(pressed: Pressed) -> Text:
    """What stays on the way: the bend, and what r is added to, by where s will point at its end."""
    lines, at, u_s = Lines(PRINTER), Fields("on.at"), number("on.start.u_s")
    size = lines.number("size", absolute(at.c_z))
    per_u_b = lines.number("per_u_b", near_inverse(number("on.start.u_b")))
    falls = _falls(pressed, at.c_x, at.c_z, pressed.k_z)
    lines.set(_ON.e_x, fma(given(pressed.recoil / pressed.k_x), at.c_x, at.s_x))
    lines.set(_ON.e_y, fma(given(pressed.k_b / pressed.k_z), size, at.s_y))
    e_y = lines.number("e_y", fma(given(pressed.drive), falls * per_u_b, _ON.e_y))
    per_e = lines.number("per_e", rough_rsqrt(fma(_ON.e_x, _ON.e_x, fma(e_y, e_y, TINY))))
    fall = lines.number("fall", fma(-given(pressed.k_zt) * u_s, e_y * per_e, pressed.k_z))
    lines.set(_ON.along, given(pressed.k_x) * near_inverse(fall))
    lines.set(_ON.bend, fma(2, _ON.along, -2))
    apart = near_inverse(larger(pressed.k_x - fall, LEAST_APART))
    lines.set(_ON.star, -times(pressed.k_xt, u_s) * (_ON.e_x * per_e) * apart)
    # Exact: s of the first stage is a difference of what follows from it.
    lines.set(_ON.r, -at.c_x / size - _ON.star)
    lines.set(_ON.size, size)
    lines.set(_ON.pull, -u_s * size)
    lines.set(_ON.press, size * per_u_b)
    return lines.part()


def rates(pressed: Pressed) -> Text:
    """The rates of t_x, t_y, q, r and of the work at y, for a step h.

    `m` and `per_m` are y^bend and its inverse, `wide` is 2 h y, `steep` 2 h / y.
    """
    lines, p = Lines(PRINTER), pressed
    t_x, t_y, q, r = numbers("t_x t_y q r")
    square, m, per_m, wide, steep, u_s = numbers("square m per_m wide steep on.start.u_s")
    ratio = lines.number("ratio", fma(r, m, _ON.star))
    left = lines.number("left", square * _ON.size, "of -c_z")
    lines.remark("Impulses of contact follow from the slips")
    s_x = fma(given(p.k_f - p.recoil * p.k_xt / p.k_x), t_x, _ON.e_x)
    lines.number("s_x", fma(times(p.recoil / p.k_x, left), ratio, s_x))
    s_y = fma(-given(p.k_b / p.k_z), left, fma(given(p.drive), q, _ON.e_y))
    lines.number("s_y", fma(given(p.k_f - p.k_b * p.k_zt / p.k_z), t_y, s_y))
    s_x, s_y = numbers("s_x s_y")
    per_s = lines.number("per_s", rsqrt(fma(s_x, s_x, fma(s_y, s_y, TINY))))
    u_x, u_y = lines.number("u_x", s_x * per_s), lines.number("u_y", s_y * per_s)
    per = lines.number("per", near_inverse(fma(-given(p.k_zt) * u_s, u_y, p.k_z)))
    pace = lines.number("pace", wide * per)
    lines.number("d_t_x", _ON.pull * u_x * pace)
    lines.number("d_t_y", _ON.pull * u_y * pace)
    n_r = lines.number("n_r", fma(ratio, ratio, 1))
    lines.number("d_q", _ON.press * (n_r * rsqrt(n_r)) * pace)
    bends = fma(times(p.k_xt, u_s), u_x, times(p.k_x, _ON.star))
    drifts = lines.number("drifts", fma(-per, bends, _ON.star) * per_m)
    steady = fma(-given(p.k_x), per, _ON.along)
    lines.number("d_r", steep * fma(steady, r, drifts))
    v = fma(given(p.approach), t_y, fma(2, q, _ON.v))
    lines.number("d_work", v * number("d_t_y"))
    return lines.part()


@dataclass(frozen=True)
class Stand:
    """A stage: what is added up until there, and the node that it stands at."""

    sums: Text
    y: float
    node: int
    length: float  # of the step

    @property
    def factors(self) -> tuple[float, ...]:
        """`square`, `wide` and `steep` of `rates`."""
        return self.y**2, 2 * self.length * self.y, 2 * self.length / self.y

    @property
    def m(self) -> str:
        """y^bend there, by the name that `_powers` gives it."""
        return f"m{self.node}" if self.y < 1 else "real(1.0)"

    @property
    def per_m(self) -> str:
        return f"p{self.node}" if self.y < 1 else "real(1.0)"


@dataclass(frozen=True)
class Way:
    """One step over y, by its name."""

    name: str
    start: float
    stop: float
    powers: Text
    stands: tuple[Stand, ...]
    ends: Text
    node_stages: tuple[int | None, ...]  # those at the nodes; none where all rates are zero


def ways(sticks: Sticks, tableau: PlainTableau, pressed: Pressed) -> tuple[Way, ...]:
    """The steps that there are: one over all, or two."""
    found = []
    for name, start, stop in (
        ("one", 1.0, 0.0),
        ("first", 1.0, sticks.cut),
        ("last", sticks.cut, 0.0),
    ):
        ys = [start - float(node) * (start - stop) for node in tableau.nodes]
        length, stands = start - stop, []
        for i, at in enumerate(tableau.c):
            node = min(range(len(ys)), key=lambda k: abs(tableau.nodes[k] - at))
            if ys[node] > 0:
                stands.append(Stand(_sums(f"z{i}_", tableau.a[i], i), ys[node], node, length))
        found.append(
            Way(
                name,
                start,
                stop,
                _powers(ys, sticks, pressed),
                tuple(stands),
                _ends(tableau, len(stands)),
                tuple(i if i < len(stands) else None for i in tableau.node_stages),
            )
        )
    return tuple(found)


def _sums(before: str, row: Row, stages: int) -> Text:
    """What is added up after weights of the first stages; there are no rates where y = 0."""
    lines = Lines(PRINTER)
    for name in SUMS:
        lines.number(f"{before}{name}", _total(name, row[:stages]))
    return lines.part()


def _total(name: str, row: Row) -> Number:
    total = number(f"on.{name}")
    for j, weight in enumerate(row):
        if weight:
            total = fma(sp.Rational(*weight.as_integer_ratio()), number(f"w{j}.{name}"), total)
    return total


def _ends(tableau: PlainTableau, stages: int) -> Text:
    lines = Lines(PRINTER)
    for name in (*SUMS, "work"):
        lines.set(number(f"on.{name}"), _total(name, tableau.b[:stages]))
    return lines.part()


def _powers(ys: Sequence[float], sticks: Sticks, pressed: Pressed) -> Text:
    """y^bend at the nodes by Taylor's polynomials, m0, m1, ..., and the inverses p0, p1, ..."""
    table = float(pressed.k_zt) * sticks.most_u_s
    ends = [2 * float(pressed.k_x) / (float(pressed.k_z) + way * table) - 2 for way in (-1, 1)]
    middle = round(sum(ends) / 2, 3)
    lines = Lines(PRINTER)
    off = lines.number("off", _ON.bend - middle)
    for i, y in enumerate(ys):
        if 0 < y < 1:
            log = sp.log(sp.Float(y, 20))
            terms = [sp.exp(middle * log) * log**k / sp.factorial(k) for k in range(TERMS)]
            total: Number | float = float(f"{float(terms[-1]):.12g}")
            for term in reversed(terms[:-1]):
                total = fma(total, off, float(f"{float(term):.12g}"))
            lines.number(f"p{i}", near_inverse(lines.number(f"m{i}", total)))
    return lines.part()


def _approach(pressed: Pressed) -> Number:
    return fma(given(pressed.approach), _ON.t_y, fma(2, _ON.q, _ON.v))


def end(pressed: Pressed) -> Text:
    """Impulses of the whole collision, `all_` and their names: friction ends with the slip."""
    lines, ended, v = Lines(PRINTER), _END, number("approach")
    at = Fields("on.at")
    kept = ended.kept * (_ON.work - _ON.after)
    aimed = fma(ended.base, v * v, fma(ended.both, _ON.work, kept))
    lines.number("v_end", sqrt(larger(aimed, 0)))
    lines.number("all_q", 0.5 * fma(-given(pressed.approach), _ON.t_y, number("v_end") + v))
    slid = fma(given(pressed.k_xt), _ON.t_x, -at.c_x)
    lines.number("all_d_x", given(1 / pressed.k_x) * slid)
    lines.number("all_d_z", given(1 / pressed.k_z) * fma(-given(pressed.k_zt), _ON.t_y, _ON.size))
    return lines.part()


@dataclass(frozen=True)
class StickText:
    """All of it, by the names of templates/ball_ball/tiers/sticking.j2."""

    surely: Text
    begin: Text
    rates: Text
    ways: tuple[Way, ...]
    end: Text
    approach: str  # approach velocity on the way
    work_after: Text
    nodes: tuple[int, ...]

    @classmethod
    def of(cls, sticks: Sticks, tableau: PlainTableau, pressed: Pressed) -> StickText:
        return cls(
            surely=surely(sticks, pressed),
            begin=begin(pressed),
            rates=rates(pressed),
            ways=ways(sticks, tableau, pressed),
            end=end(pressed),
            approach=PRINTER.print(_approach(pressed).form),
            work_after=work_after(tableau, pressed),
            nodes=tuple(range(len(tableau.nodes))),
        )
