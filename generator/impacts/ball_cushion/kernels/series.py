"""Power series of the cushion's slips in the normal impulse, in place of steps where they hold.

The rates of the slips are products and inverse lengths of the slips themselves, so each coefficient
of their series follows from those before. The last ones say how far the series holds, so no step is
refused, and events and the end are roots of polynomials. docs/cushion.md says what the constants
are for; they were found by trial on random impacts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy as sp

from ....lowering.printer import ExpressionPrinter, number
from ....lowering.statements import Assign, Part, lower
from .. import symbols as s
from ..contact import velocity_rates
from ..reduced import slip_rates, stuck_table
from .forms import KIND, coefficients

_HOME = sp.Symbol("home", real=True)  # the cosine where no friction is needed for it


@dataclass(frozen=True)
class SeriesParts:
    """Statements for one coefficient of the series."""

    rates: Part  # of c_x, c_z, s_x, s_y and v
    stuck_table: Part  # t_x, t_y
    stuck_along: Part  # d_x of a stuck nose, from t_x
    lane_rates: Part  # `rates` in lanes
    lane_along: Part  # `stuck_along` in lanes


@dataclass(frozen=True)
class Series:
    """The order of the series and the constants of its control."""

    order: int
    parts: SeriesParts
    share: float = 0.04  # terms of the last order, at most
    before_last: float = 3.0  # times it: terms of the order before
    most_gain: float = 100.0  # times more, where the ball moves along the cushion
    nearly: float = 0.85  # of a slip that passes zero closely may be lost in a step
    there: float = 0.03  # how exactly
    away: float = 0.25  # square of the way to zero, at the present rate, up to which none is near
    aside: float = 0.25  # tolerances by which such a slip may turn without it
    beyond: float = 1.3  # of the impulse that is left at the present rate
    near: float = 0.001  # slips below may jump to zero, or follow their balance; in lanes none are
    jumps: float = 0.3  # error of a jump by slip, duration and turning
    spare: float = 0.2  # of the square of friction that holds a slip, for a jump
    patience: float = 4.0  # times the duration of a jump that must be left before the end
    margin: float = 0.01  # of friction that a nose must have left to stick by a jump
    lag: float = 4.0  # how far a slip may lag behind its balance, by its square
    join: float = 3.0  # and in tolerances beyond
    settled: float = 0.5  # what a pass may change in friction, in tolerances, to be the last
    passes: int = 6
    further: float = 1.5  # by which the search for the end of a slip goes on
    little: float = 0.01  # restitution squared below it needs the end of compression exactly
    rough: float = 0.001  # of a step, else
    enough: float = 0.3  # last step to the end by the root of what it may be off
    tiny: float = 1e-6  # way to the end whose work is no difference of sums
    most: int = 200  # steps
    least_in_lanes: float = 1e-6  # shorter steps are made alone
    lane_turns: int = 3  # of Newton's method for either end of a phase
    slippery: float = 1e-100  # friction below it turns nothing, and its square may be no number

    @property
    def kept(self) -> str:
        """What a step leaves of a slip that passes zero closely."""
        return number(1 - sp.Rational(str(self.nearly)))

    @property
    def to_passing(self) -> str:
        """The way to zero, by that of which `nearly` is lost, were a slip to fall evenly."""
        return number(1 / sp.Rational(str(self.nearly)))

    @property
    def root(self) -> tuple[int, int]:
        """In lanes: 64ths whose product is the exponent of the root of the last order, nearly."""
        return root_in_64ths(self.order)

    @property
    def root_before(self) -> tuple[int, int]:
        return root_in_64ths(self.order - 1)

    @property
    def parts_of_one(self) -> tuple[str, ...]:
        """1/k, of an integral's coefficient k."""
        return tuple(number(sp.Rational(1, k)) for k in range(1, self.order + 1))


def root_in_64ths(order: int) -> tuple[int, int]:
    """a and b, with a b / 4096 as near to 1 / order as can be, the larger first."""
    pairs = ((a, b) for a in range(1, 65) for b in range(1, a + 1))
    return min(pairs, key=lambda p: (abs(p[0] * p[1] * order - 64**2), p))


def series_for(budget: float, place_fma: bool) -> Series:
    """Low orders are cheap, high ones go far at small tolerances."""
    series = Series(10, _parts(place_fma))
    if budget > 1e-5:
        return replace(series, order=6, near=0.14, share=0.03, jumps=1.0, nearly=1.0, aside=1.0)
    return replace(series, order=14, share=0.01) if budget < 1e-7 else series


def _parts(place_fma: bool) -> SeriesParts:
    names = {name: f"n.{name}" for name in ("m", "g", "a")} | {"S": "n.sine"}
    printer = ExpressionPrinter(place_fma, names)
    in_lanes = {name: text.replace("n.", "z.") for name, text in names.items()}
    lanes = ExpressionPrinter(True, in_lanes, fma_name="fma", number_format="real({})")
    table = ExpressionPrinter(place_fma, {**names, "m": "z.m", "g": "z.g", "S": "z.sine"})
    named, slips = coefficients(), slip_rates()
    forms = {n: named.named(slips[c]) for n, c in (("c_x", s.C_X), ("c_z", s.C_Z))}
    forms |= {n: named.named(slips[c]) for n, c in (("s_x", s.S_X), ("s_y", s.S_Y))}
    forms["v"] = named.named(velocity_rates()[s.V_Y])
    held = {str(t): named.named(form).subs(s.COS, _HOME) for t, form in stuck_table().items()}
    along = sp.solve(named.named(slips[s.C_X]), s.D_X)[0]
    rates = {f"rate.{n}": form.subs(s.COS, _HOME) for n, form in forms.items()}
    return SeriesParts(
        rates=_part(printer, rates, ""),
        lane_rates=_part(lanes, rates, ""),
        stuck_table=_part(table, held, KIND),
        stuck_along=_part(table, {"d_x": along}, KIND),
        lane_along=_part(lanes, {"f.d_x[n]": along.subs(s.COS, _HOME)}, ""),
    )


def _part(printer: ExpressionPrinter, forms: dict[str, sp.Expr], kind: str) -> Part:
    block = lower([Assign(name, form, kind) for name, form in forms.items()], printer)
    return Part(tuple(block.lines), block.counts)
