"""Fixed steps over a collision or its phases, and the work that says where they end.

With T_y the sum of table friction along the line of centres and J its work, v_n at the end is
v_e^2 = e_b^2 v_n0^2 + 2 J - 2 (1 - e_b^2) J_c. J_c, the work until v_n = 0, is taken from the
polynomial through the rates at the tableau's nodes.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp

from .....lowering.lane_algebra import (
    Fields,
    Lines,
    Number,
    constant,
    fma,
    given,
    larger,
    near_inverse,
    number,
    rough_rsqrt,
    sqrt,
)
from .....lowering.printer import ExpressionPrinter
from .....tableaus.plain import PlainTableau
from ..exact.pressed import Pressed

Text = tuple[str, ...]
LEAST_STEP = 1e-12  # m/s; lanes that are no collisions may have any
IMPULSES = ("d_x", "d_z", "t_x", "t_y")
PRINTER = ExpressionPrinter(True, fma_name="fma", number_format="real({})")
_AT, _H, _V0 = Fields("at"), number("h"), number("v0")


def stage(tableau: PlainTableau, pressed: Pressed, i: int) -> Text:
    """Impulses until stage i, and the slips that they lead to: sum_ and y_ of their names."""
    lines = Lines(PRINTER)
    sums = {name: _weighed(lines, f"sum_{name}", tableau.a[i], name) for name in IMPULSES}
    share = _rational(tableau.c[i])
    d_x, d_z, t_x, t_y = (sums[name] for name in IMPULSES)
    lines.number("y_c_x", _plus(_plus(_AT.c_x, pressed.k_x, d_x), -pressed.k_xt, t_x))
    lines.number("y_c_z", _plus(_plus(_AT.c_z, pressed.k_z, d_z), pressed.k_zt, t_y))
    lines.number("y_s_x", _plus(_plus(_AT.s_x, -pressed.recoil, d_x), pressed.k_f, t_x))
    driven = _plus(_AT.s_y, pressed.drive * share, _H)
    lines.number("y_s_y", _plus(_plus(driven, pressed.k_b, d_z), pressed.k_f, t_y))
    if tableau.b[i]:
        lines.number("v", _plus(_plus(_V0, 2 * share, _H), pressed.approach, t_y))
    return lines.part()


def stage_alone(tableau: PlainTableau, pressed: Pressed, i: int) -> Text:
    """The same for one collision: all but what the last rates add is made before they are there.

    One or two operations then lie between the rates of a stage and the slips of the next, where
    `stage` has three, for four operations more.
    """
    lines, row = Lines(PRINTER), tableau.a[i]
    early = {n: _weighed(lines, f"early_{n}", row[:-1], n) for n in IMPULSES if any(row[:-1])}
    share, last = _rational(tableau.c[i]), _rational(row[-1])

    def moved(name: str, base: Number, *shares: tuple[sp.Expr, str]) -> None:
        for weight, impulse in shares if early else ():
            base = _plus(base, weight, early[impulse])
        base = lines.number(f"early_{name}", base)
        for weight, impulse in shares:
            base = _plus(base, weight * last, number(f"k{i - 1}.{impulse}"))
        lines.number(name, base)

    driven = _plus(_AT.s_y, pressed.drive * share, _H)
    moved("y_c_x", _AT.c_x, (pressed.k_x, "d_x"), (-pressed.k_xt, "t_x"))
    moved("y_c_z", _AT.c_z, (pressed.k_z, "d_z"), (pressed.k_zt, "t_y"))
    moved("y_s_x", _AT.s_x, (-pressed.recoil, "d_x"), (pressed.k_f, "t_x"))
    moved("y_s_y", driven, (pressed.k_b, "d_z"), (pressed.k_f, "t_y"))
    if tableau.b[i]:
        moved("v", _plus(_V0, 2 * share, _H), (pressed.approach, "t_y"))
    return lines.part()


def end(tableau: PlainTableau, pressed: Pressed, alone: bool) -> Text:
    """Impulses of the whole collision, `all_` and their names."""
    lines = Lines(PRINTER)
    sums = {name: _weighed(lines, f"sum_{name}", tableau.b, name) for name in IMPULSES}
    work = _sum(lines, "j", [(w, number(f"j{i}")) for i, w in enumerate(tableau.b) if w])
    rates = [number(f"k{i}.t_y") for i in tableau.node_stages]
    until = _sum_of(lines, "until", "end.t", rates)
    inner = _sum_of(lines, "inner", "end.i", rates)
    ended = Fields("end")
    q_c = lines.number("q_c", ended.w * _H)
    # v_n is not quite zero at q_c: with it J_c hardly depends on where q_c is.
    middle = lines.number("middle", fma(0.5 * given(pressed.approach), until, fma(2, q_c, _V0)))
    work_c = lines.number("j_c", fma(-2 * _H, inner, until * middle))
    aimed = fma(ended.base, _V0 * _V0, fma(_both(alone), work, ended.kept * work_c))
    v_end = lines.number("v_end", sqrt(larger(aimed, 0)))
    v = lines.number("v", _plus(fma(2, _H, _V0), pressed.approach, sums["t_y"]))
    last = tableau.stages - 1
    rest = _rest(lines, pressed, v_end - v, f"k{last}", alone)
    lines.number("all_q", _H + number("dq"))
    for name in IMPULSES:
        lines.number(f"all_{name}", fma(rest, number(f"k{last}.{name}"), sums[name]))
    return lines.part()


def advance(tableau: PlainTableau, pressed: Pressed) -> Text:
    """The state after a step: met.at, met.v0, and what has been added up."""
    lines, met = Lines(PRINTER), Fields("met")
    d_x, d_z, t_x, t_y = (_weighed(lines, f"sum_{n}", tableau.b, n) for n in IMPULSES)
    powers = [(w, number(f"j{i}")) for i, w in enumerate(tableau.b) if w]
    lines.set(met.work, met.work + _sum(lines, "j", powers))
    at = Fields("met.at")
    lines.set(at.c_x, _plus(_plus(at.c_x, pressed.k_x, d_x), -pressed.k_xt, t_x))
    lines.set(at.c_z, _plus(_plus(at.c_z, pressed.k_z, d_z), pressed.k_zt, t_y))
    lines.set(at.s_x, _plus(_plus(at.s_x, -pressed.recoil, d_x), pressed.k_f, t_x))
    driven = _plus(at.s_y, pressed.drive, _H)
    lines.set(at.s_y, _plus(_plus(driven, pressed.k_b, d_z), pressed.k_f, t_y))
    lines.set(met.v0, _plus(fma(2, _H, met.v0), pressed.approach, t_y))
    for name, value in zip(IMPULSES, (d_x, d_z, t_x, t_y), strict=True):
        total = Fields("met.done")
        lines.set(getattr(total, name), getattr(total, name) + value)
    lines.set(number("met.done.q"), number("met.done.q") + _H)
    return lines.part()


def turn(tableau: PlainTableau, pressed: Pressed) -> Text:
    """Between the phases: J_c, and the length of the second, from the last rates of the first."""
    lines, met, at, ended = Lines(PRINTER), Fields("met"), Fields("met.at"), Fields("end")
    last = f"k{tableau.stages - 1}"
    per_h = lines.number("per_h", near_inverse(larger(_H, LEAST_STEP)))
    d_x, d_z, t_x, t_y = (lines.number(f"r_{n}", number(f"{last}.{n}") * per_h) for n in IMPULSES)
    # v_n is not quite zero there; what J lacks is of its square.
    lines.set(met.work_c, fma(-0.25 * met.v0 * met.v0, t_y, met.work))
    left = fma(2, met.work_c, met.approach * met.approach)
    bounce = lines.number("bounce", ended.bounce * sqrt(larger(left, 0)))
    half = lines.number("half", 0.5 * bounce)
    s_x = _plus(-given(pressed.recoil) * d_x, pressed.k_f, t_x)
    s_y = _plus(fma(given(pressed.k_b), d_z, given(pressed.drive)), pressed.k_f, t_y)
    e_x = lines.number("e_x", fma(half, s_x, at.s_x))
    e_y = lines.number("e_y", fma(half, s_y, at.s_y))
    rubs = lines.number("rubs", sqrt(fma(t_x, t_x, t_y * t_y)))
    per_e = rough_rsqrt(fma(e_x, e_x, fma(e_y, e_y, constant("kTinySquare"))))
    f_1 = lines.number("f_1", -rubs * (e_y * per_e))
    rise = fma(sp.Rational(1, 3), t_y, fma(sp.Rational(1, 6), f_1, 2))
    lines.number("whole", (bounce - met.v0) * near_inverse(rise))
    return lines.part()


def finish(tableau: PlainTableau, pressed: Pressed, alone: bool) -> Text:
    """Impulses of the whole collision after the last step, `all_` and their names."""
    lines, met, ended = Lines(PRINTER), Fields("met"), Fields("end")
    first = met.approach * met.approach
    aimed = fma(ended.base, first, fma(_both(alone), met.work, ended.kept * met.work_c))
    v_end = lines.number("v_end", sqrt(larger(aimed, 0)))
    last = tableau.stages - 1
    rest = _rest(lines, pressed, v_end - met.v0, f"k{last}", alone)
    lines.number("all_q", number("met.done.q") + number("dq"))
    for name in IMPULSES:
        lines.number(
            f"all_{name}", fma(rest, number(f"k{last}.{name}"), number(f"met.done.{name}"))
        )
    return lines.part()


def _both(alone: bool) -> Number | int:
    """What the work of table friction is weighed by in v_n^2: alone, 0 where v_n ends at zero."""
    return number("end.both") if alone else 2


def _rest(lines: Lines, pressed: Pressed, lacking: Number, last: str, alone: bool) -> Number:
    """The share of a step that v_n lacks until the end, by the rates at the last stage; dq of it.

    v_n at the end moves with what is missing by those rates, too; but not where it is zero, so that
    they count there: 1 / (2 + t) is 1/2 - t/4 for a dq that is small itself.
    """
    per_h = lines.number("per_h", near_inverse(larger(_H, LEAST_STEP)))
    half: Number | float = 0.5
    if alone:
        drag = number("end.stays") * per_h
        half = fma(-given(pressed.approach) * drag, number(f"{last}.t_y"), 0.5)
    return lines.number("rest", lines.number("dq", half * lacking) * per_h)


def end_weights(tableau: PlainTableau) -> tuple[tuple[str, str], ...]:
    """C++ of what depends on e_b alone, by name: in doubles, once a batch or call."""
    w, v, x = sp.symbols("w v x", real=True)
    nodes = [_rational(n) for n in tableau.nodes]
    printer = ExpressionPrinter(False)
    found = []
    for i, node in enumerate(nodes):
        others = [n for j, n in enumerate(nodes) if j != i]
        cubic = sp.prod([(x - n) / (node - n) for n in others])
        once = sp.integrate(sp.expand(cubic), (x, 0, v))
        twice = sp.integrate(sp.expand(once), (v, 0, w))
        for name, form in (("t", once.subs(v, w)), ("i", twice)):
            found.append((f"{name}{i}", _horner(printer, sp.Poly(form, w))))
    return tuple(found)


def _horner(printer: ExpressionPrinter, form: sp.Poly) -> str:
    text = ""
    for coefficient in form.all_coeffs():
        value = printer.print(coefficient)
        text = f"({text}) * w + {value}" if text else value
    return text


def _sum_of(lines: Lines, name: str, weights: str, values: Sequence[Number]) -> Number:
    total = number(f"{weights}0") * values[0]
    for i, value in enumerate(values[1:], 1):
        total = fma(number(f"{weights}{i}"), value, total)
    return lines.number(name, total)


def _rational(value: Fraction) -> sp.Rational:
    return sp.Rational(*value.as_integer_ratio())


def _weighed(lines: Lines, target: str, row: Sequence[Fraction], name: str) -> Number:
    return _sum(lines, target, [(w, number(f"k{j}.{name}")) for j, w in enumerate(row) if w])


def _sum(lines: Lines, name: str, weights: Sequence[tuple[Fraction, Number]]) -> Number:
    (first, value), *others = weights
    total = given(_rational(first)) * value
    for weight, other in others:
        total = fma(given(_rational(weight)), other, total)
    return lines.number(name, total)


def _plus(base: Number, share: sp.Expr, value: Number) -> Number:
    """base + share * value, in one operation; without one where the share is zero."""
    return base if share == 0 else fma(given(share), value, base)
