"""From velocities to the reduced state and back, where only differences are made in doubles.

What a collision changes is added to the velocities as they came, so that floats round changes, not
velocities.
"""

from __future__ import annotations

from functools import reduce

import sympy as sp

from .....lowering.lane_algebra import (
    InLanes,
    Lines,
    Mask,
    Number,
    absolute,
    both,
    fma,
    given,
    inverse_of_power,
    larger,
    mask,
    number,
    power_of_two,
    select,
    smaller,
    sqrt,
    where,
)
from ... import symbols as s
from ...contact import lift_changes, slips, velocity_changes
from ...reduced import EQUAL_MASSES
from ...terms import ContactTerms
from .whole import PRINTER, Text

# Where differences are good enough in floats, and squares stay in range; NaN is outside.
MOST_SPIN = 10  # R |w|, of |v1 - v2| or of the contact slip
MOST_SLIP = 1000  # on the table, of |v1 - v2|
LEAST_APPROACH = 3e-5  # of |v1 - v2|
SPEEDS = (1e-6, 1e4)  # |v1 - v2|, m/s
DISTANCES = (1e-9, 1e9)  # of the centres, m
LEVEL = 0.99e-6  # of the distance: how far the line of centres may rise
LEVEL_SLIP = 1e-8  # of c_x: a vertical slip that presses no ball
_R = sp.Symbol("R", real=True)
_AXES = "xyz"
SCALED = ("c_x", "c_z", "s_x", "s_y", "approach")


def _ball(name: str, at: int) -> sp.Symbol:
    return sp.Symbol(f"{name}[{at}]", real=True)


def differences(terms: ContactTerms) -> tuple[tuple[str, str], ...]:
    """What is made in doubles, by name: `one` and `two` are the balls' columns, R the radius."""
    one, two = ([_ball(name, i) for i in range(9)] for name in ("one", "two"))
    found = [(f"d_{axis}", two[i] - one[i]) for i, axis in enumerate(_AXES)]
    found += [(f"v_{axis}", one[3 + i] - two[3 + i]) for i, axis in enumerate(_AXES)]
    found += [(f"o_{axis}", _R * (one[6 + i] + two[6 + i])) for i, axis in enumerate(_AXES)]
    values = {v: one[3 + i] for i, v in enumerate(s.V1)} | {
        v: two[3 + i] for i, v in enumerate(s.V2)
    }
    values |= {o: _R * one[6 + i] for i, o in enumerate(s.O1)}
    values |= {o: _R * two[6 + i] for i, o in enumerate(s.O2)}
    slip = slips(terms)
    for name in ("s1x", "s1y", "s2x", "s2y"):
        found.append((name, getattr(slip, name).subs(values)))
    return tuple((name, PRINTER.print(form)) for name, form in found)


def sizes() -> tuple[tuple[str, str], ...]:
    """Squares of what comes in, by name: speeds, spins and the distance of the centres."""
    one, two = ([number(f"{name}[{i}]") for i in range(9)] for name in ("one", "two"))
    apart = [one[i] - two[i] for i in range(3)]
    squares = (("speeds", [*one[3:6], *two[3:6]]), ("spins", [*one[6:], *two[6:]]))
    found = []
    for name, values in (*squares, ("apart", apart)):
        total = values[0] * values[0]
        for value in values[1:]:
            total = fma(value, value, total)
        found.append((name, PRINTER.print(total.form)))
    return tuple(found)


def entering(terms: ContactTerms) -> Text:
    """The contact frame and the reduced state, from differences; what is `ordinary` and `level`."""
    lines = Lines(PRINTER)
    d_x, d_y = number("d_x"), number("d_y")
    square = lines.number("square", fma(d_x, d_x, d_y * d_y))
    per = lines.number("per_distance", 1 / sqrt(larger(square, DISTANCES[0] ** 2)))
    lines.number("f_x", d_x * per)
    lines.number("f_y", d_y * per)
    lines.number("along", _across("v_x", "v_y"))
    v = lines.number("approach", _forwards("v_x", "v_y"))
    lines.number("spun", _across("o_x", "o_y"))
    # Slips of contact are slips of differences: of a ball 2 that stands still.
    names = dict(zip((*s.V1, *s.O1), ("along", "approach", "v_z", "spun", "", "o_z"), strict=True))
    values = {symbol: sp.Symbol(name, real=True) for symbol, name in names.items() if name}
    values |= dict.fromkeys((*s.V2, *s.O2), sp.Integer(0))
    slip = slips(terms)
    c_x = lines.number("c_x", InLanes(slip.c_x.subs(values)))
    c_z = lines.number("c_z", InLanes(slip.c_z.subs(values)))
    first = lines.mask("first", c_z > 0, "is ball 1 the pressed one?")
    lines.number("u_s", select(first, number("end.u_s1"), number("end.u_s2")))
    for axis in "xy":
        own = select(first, -number(f"s1{axis}"), number(f"s2{axis}"))
        lines.number(f"w_{axis}", own)
    lines.number("s_x", _across("w_x", "w_y"))
    lines.number("s_y", _forwards("w_x", "w_y"))
    along, v_z = number("along"), number("v_z")
    speed_2 = lines.number("speed_2", fma(along, along, fma(v, v, v_z * v_z)))
    lines.remark("Speeds of about 1: what is added to squares is then far below rounding")
    true = lines.number("speed", sqrt(speed_2))
    scale = lines.number("scale", power_of_two(larger(true, SPEEDS[0])))
    per_scale = lines.number("per_scale", inverse_of_power(scale))
    for name in SCALED:
        lines.number(f"{name}_1", number(name) * per_scale)
    lines.number("relative", true * per_scale)
    lines.mask("level", absolute(c_z) <= LEVEL_SLIP * absolute(c_x))
    lines.mask("ordinary", _ordinary())
    return lines.part()


def _ordinary() -> Mask:
    """One mask for all that this way is not made for: NaN and infinity fail it, too."""
    speed, speed_2, square = number("speed"), number("speed_2"), number("square")
    c_x, c_z = number("c_x"), number("c_z")
    w_x, w_y, rise = number("w_x"), number("w_y"), number("d_z") * number("per_distance")
    tests = (
        number("approach") > LEAST_APPROACH * speed,
        number("spin_2") <= MOST_SPIN**2 * (speed_2 + fma(c_x, c_x, c_z * c_z)),
        fma(w_x, w_x, w_y * w_y) <= MOST_SLIP**2 * speed_2,
        speed_2 >= SPEEDS[0] ** 2,
        speed_2 <= SPEEDS[1] ** 2,
        square >= DISTANCES[0] ** 2,
        square <= DISTANCES[1] ** 2,
        absolute(rise) <= LEVEL,
        number("u_b") >= 0,
    )
    return reduce(both, tests)


def leaving(terms: ContactTerms) -> Text:
    """Changes of the velocities on the table's axes, `more_` and their names.

    From the impulses q, d_x, d_z, t_x, t_y of a ball 2 that is pressed, `first` and f.
    """
    lines = Lines(PRINTER)
    first, d_z = mask("first"), number("d_z")
    for axis in "xy":
        t = number(f"t_{axis}")
        lines.number(f"t1{axis}", where(first, -t))
        lines.number(f"t2{axis}", select(first, 0, t))
    pressed_z = lines.number("pressed_z", select(first, -d_z, d_z))
    names = {s.DQ: "q", s.D_X: "d_x", s.D_Z: "pressed_z"}
    names |= {s.T1X: "t1x", s.T1Y: "t1y", s.T2X: "t2x", s.T2Y: "t2y"}
    values = {symbol: sp.Symbol(name, real=True) for symbol, name in names.items()}
    for velocity, change in velocity_changes().items():
        form = sp.expand(change.subs(EQUAL_MASSES).subs(values))
        lines.number(f"own_{velocity.name}", InLanes(form))
    per_radius = number("end.per_radius")
    for ball in "12":
        for axis in _AXES:
            name = f"turned_o{ball}{axis}"
            lines.number(name, number(f"own_o{ball}{axis}") * per_radius)
        _turn_back(lines, f"own_v{ball}", f"more_v{ball}")
        _turn_back(lines, f"turned_o{ball}", f"more_o{ball}")
        lines.number(f"more_o{ball}z", number(f"turned_o{ball}z"))
    if terms.lift:
        up = lift_changes(2)[s.V1[2]].coeff(s.D_Z).subs(EQUAL_MASSES)
        down = lift_changes(1)[s.V2[2]].coeff(s.D_Z).subs(EQUAL_MASSES)
        lines.number("more_v1z", given(up) * larger(pressed_z, 0))
        lines.number("more_v2z", given(down) * smaller(pressed_z, 0))
    return lines.part()


def changed(terms: ContactTerms) -> tuple[str, ...]:
    """The names of the changes in the order of outputs; empty where a velocity stays."""
    names = [f"more_{kind}{ball}{axis}" for ball in "12" for kind in "vo" for axis in _AXES]
    return tuple("" if not terms.lift and n in ("more_v1z", "more_v2z") else n for n in names)


def _turn_back(lines: Lines, own: str, to: str) -> None:
    """From the axes of the contact to those of the table."""
    x, y, f_x, f_y = (number(name) for name in (f"{own}x", f"{own}y", "f_x", "f_y"))
    lines.number(f"{to}x", fma(x, f_y, y * f_x))
    lines.number(f"{to}y", fma(y, f_y, -x * f_x))


def _across(x: str, y: str) -> Number:
    """Of a vector of the table: across the line of centres."""
    return fma(number(x), number("f_y"), -number(y) * number("f_x"))


def _forwards(x: str, y: str) -> Number:
    return fma(number(x), number("f_x"), number(y) * number("f_y"))
