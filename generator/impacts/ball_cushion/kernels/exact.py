"""The exact stepper of the cushion: a Runge-Kutta method in the normal impulse, and its control.

The state is c_x, c_z, s_x and v_y in units of the approach speed, so a constant of the control is a
share of it, or without unit. docs/cushion.md says what each is for. The values
were found by trial on random impacts, they are not derived.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy as sp

from ....lowering.printer import decimal_product, number
from ....registry.recipe import SERIES
from ....tableaus.tableau import Row, Tableau
from ....tableaus.tableaus import TABLEAUS
from .. import symbols as s
from ..reduced import slip_rates
from .forms import ExactParts, exact_parts
from .series import Series, series_for

# Bits of x^(-1/5): those of 1 times 6/5, less a fifth of those of x; the shift halves the error.
_ROOT_SHIFT = sp.Rational(45, 1000)
_ROOT_OFFSET = int(sp.Rational(6, 5) * (1023 - _ROOT_SHIFT) * 2**52)
SERIES_STEPS = "dp54"  # with an interpolant of one term, on which events are met
STEPPERS = (SERIES, SERIES_STEPS)


@dataclass(frozen=True)
class Control:
    """Constants of the control of steps. Those that are lengths are shares of the error budget."""

    tolerance: float = 0.1  # embedded error of a step
    sharing: float = 0.1  # by which each step before lessens the tolerance of one
    zero: float = 0.15  # a slip below it is none
    landed: float = 0.03  # how near to zero a slip that follows its balance counts as there
    stray: float = 0.04  # what following the balance may be off, summed, before the slip is stepped
    join: float = 0.04  # how far off its balance a slip may be for following it
    driven: float = 1000.0  # times what a slip strays that the table drives on
    join_aside: float = 0.16  # and how far its rate may point aside, times its length
    safe: float = 0.85  # share of the next step that the error's order allows
    least_factor: float = 0.15  # of one step to the next
    most_factor: float = 5.0
    reach: float = 0.8  # share of a slip that a step may remove
    head_on: float = 0.002  # what a step leaves of a slip that falls straight to zero
    aside: float = 4.0  # times the slip's angle off the straight way is left, too
    turn_nose: float = 0.6  # radians by which a step may turn the slip at the nose
    turn_table: float = 0.6  # of the slip on the table
    stable: float = 2.0  # of a step in the time in which friction returns a slip to its balance
    growth: float = 8.0  # times a slip that a step may add to it
    near: float = 0.3  # slips below are tried for following their balance
    beyond: float = 1.02  # of the impulse that is left at the present rate, for the last step
    rejected: float = 0.9  # of a step that is refused, at most
    surely: float = 0.002  # an event's quantity must pass zero by it, to count as undone
    met: float = 0.001  # an event's quantity below it is zero
    narrow: float = 1e-13  # part of a step below which a root is not narrowed
    balanced: float = 4e-16  # how far from 1 the length of a direction in balance may be
    found: float = 1e-9  # and where it counts as found at all
    shortest: float = 1e-13
    slowest: float = 1e-30
    noise: float = 4e-16
    most_turns: int = 60
    most_tries: int = 60
    most_steps: int = 100_000


def control_for(budget: float) -> Control:
    """Loose steps see less of what comes, so they keep further from it."""
    usual = Control()
    return replace(usual, tolerance=0.05) if budget > 1e-5 else usual


@dataclass(frozen=True)
class Weight:
    """One term of a sum over stages."""

    value: str
    stage: int


Sum = tuple[Weight, ...]


@dataclass(frozen=True)
class ExactStepper:
    """What the templates need of the stepper."""

    tableau: Tableau
    budget: float
    control: Control
    parts: ExactParts
    stages: tuple[Sum, ...]  # the second and later ones; the last is the first of the next step
    error: Sum
    bend: Sum  # the interpolant's term beyond the cubic
    table_rate: str  # of the table's slip per its friction
    series: Series | None = None  # where steps only go on where the series do not hold
    huge: str = "1e300"
    tiny_square: str = "1e-300"
    gauss_point: str = number(sp.sqrt(sp.Rational(3, 5)) / 2)
    gauss_side: str = number(sp.Rational(5, 18))
    gauss_middle: str = number(sp.Rational(4, 9))
    least_error: str = "1e-12"
    most_error: str = "1e12"
    root_offset: int = _ROOT_OFFSET

    @property
    def left_most(self) -> str:
        """What a step leaves of a slip, where it is not head-on."""
        return number(1 - sp.Rational(str(self.control.reach)))

    @property
    def per_tolerance(self) -> str:
        return number(
            1 / (sp.Rational(str(self.control.tolerance)) * sp.Rational(repr(self.budget)))
        )

    @property
    def last(self) -> int:
        """The stage at the end of the step."""
        return len(self.stages)

    def share(self, of_budget: float) -> str:
        """A length as C++ text."""
        return decimal_product(of_budget, self.budget)


def exact_stepper(name: str, budget: float, place_fma: bool) -> ExactStepper:
    """Raises ValueError where there is no such stepper of the cushion."""
    if name not in STEPPERS:
        raise ValueError(f"ball-cushion has no stepper {name}; there is {', '.join(STEPPERS)}")
    tableau = TABLEAUS[SERIES_STEPS]
    return ExactStepper(
        tableau=tableau,
        budget=budget,
        control=control_for(budget),
        parts=exact_parts(place_fma),
        stages=tuple(_sum(row) for row in tableau.a[1:]),
        error=_sum(tableau.error),
        bend=_sum(tableau.dense[0]),
        table_rate=number(slip_rates()[s.S_X].coeff(s.T_X)),
        series=series_for(budget, place_fma) if name == SERIES else None,
    )


def _sum(weights: Row) -> Sum:
    """The weights that are not zero, as C++ text, exact until they are printed."""
    exact = enumerate(sp.Rational(w.numerator, w.denominator) for w in weights)
    return tuple(Weight(number(w), stage) for stage, w in exact if w != 0)


def exact_method(stepper: ExactStepper) -> tuple[str, ...]:
    """What the contract says of the stepper."""
    counts, series = stepper.parts.step_counts, stepper.series
    steps = f"adaptive {stepper.tableau.name} in the normal impulse, order {stepper.tableau.order}"
    if series:
        steps = f"power series in the normal impulse, order {series.order}, else {steps}"
    return (
        f"Stepper: {steps}; sticking, release, a lifted table contact and the ends are met "
        f"as events. Error against the exact solution at most {stepper.budget:g} of the speed, "
        "each of v and R w, as far as verification has seen.",
        f"Operations of one evaluation of the rates: {counts.describe()} ({counts.flops} flops), "
        "and two inverse roots.",
    )
