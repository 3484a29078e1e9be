"""Fixed steps to where contact sticks, c = 0 (which collisions surely do, says sure_sticking.py).

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
    Number,
    absolute,
    fma,
    given,
    larger,
    near_inverse,
    number,
    numbers,
    rough_rsqrt,
    rsqrt,
    sqrt,
)
from .....tableaus.plain import PlainTableau
from .....tableaus.tableau import Row
from ..exact.lengths import times
from ..exact.pressed import Pressed
from .bounds import Sticks
from .crossing import work_after
from .sure_sticking import TINY, fall_of, surely
from .whole import PRINTER, Text

LEAST_APART = 0.3  # k_x - k_z of `star`, where they nearly balance
TERMS = 8  # of a polynomial for a power
SUMS = ("t_x", "t_y", "q", "r")
_ON, _END = Fields("on"), Fields("end")


def begin(pressed: Pressed) -> Text:
    """What stays on the way: the bend, and what r is added to, by where s will point at its end."""
    lines, at, u_s = Lines(PRINTER), Fields("on.at"), number("on.start.u_s")
    size = lines.number("size", absolute(at.c_z))
    per_u_b = lines.number("per_u_b", near_inverse(number("on.start.u_b")))
    falls = fall_of(pressed, at.c_x, at.c_z, pressed.k_z)
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


def slips(pressed: Pressed) -> Text:
    """Where the table slip is: `s_x` and `s_y` from what has been added up."""
    lines, p = Lines(PRINTER), pressed
    t_x, t_y, q, r = numbers("t_x t_y q r")
    square, m = numbers("square m")
    ratio = lines.number("ratio", fma(r, m, _ON.star))
    left = lines.number("left", square * _ON.size, "of -c_z")
    lines.remark("Impulses of contact follow from the slips")
    s_x = fma(given(p.k_f - p.recoil * p.k_xt / p.k_x), t_x, _ON.e_x)
    lines.number("s_x", fma(times(p.recoil / p.k_x, left), ratio, s_x))
    s_y = fma(-given(p.k_b / p.k_z), left, fma(given(p.drive), q, _ON.e_y))
    lines.number("s_y", fma(given(p.k_f - p.k_b * p.k_zt / p.k_z), t_y, s_y))
    return lines.part()


def rates(pressed: Pressed) -> Text:
    """The rates of t_x, t_y, q, r and of the work at y, for a step h, where the slip is s.

    `m` and `per_m` are y^bend and its inverse, `wide` is 2 h y, `steep` 2 h / y.
    """
    lines, p = Lines(PRINTER), pressed
    t_y, q, r = numbers("t_y q r")
    m, per_m, wide, steep, u_s = numbers("m per_m wide steep on.start.u_s")
    ratio = lines.number("ratio", fma(r, m, _ON.star))
    s_x, s_y = Fields("s").x, Fields("s").y
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


def end(pressed: Pressed, alone: bool) -> Text:
    """Impulses of the whole collision, `all_` and their names: friction ends with the slip."""
    lines, ended, v = Lines(PRINTER), _END, number("approach")
    at = Fields("on.at")
    kept = ended.kept * (_ON.work - _ON.after)
    aimed = fma(ended.base, v * v, fma(ended.both if alone else 2, _ON.work, kept))
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
    slips: Text
    rates: Text
    ways: tuple[Way, ...]
    end: Text
    approach: str  # approach velocity on the way
    work_after: Text
    nodes: tuple[int, ...]

    @classmethod
    def of(cls, sticks: Sticks, tableau: PlainTableau, pressed: Pressed, alone: bool) -> StickText:
        return cls(
            surely=surely(sticks, pressed),
            begin=begin(pressed),
            slips=slips(pressed),
            rates=rates(pressed),
            ways=ways(sticks, tableau, pressed),
            end=end(pressed, alone),
            approach=PRINTER.print(_approach(pressed).form),
            work_after=work_after(tableau, pressed),
            nodes=tuple(range(len(tableau.nodes))),
        )
