"""What the templates of the exact steppers may see."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .....lowering.counts import OperationCounts
from .....lowering.lane_roots import LaneRoots
from .....lowering.printer import decimal_product
from .....steppers.budgets import StepControl
from .....tableaus.tableau import Tableau
from .coefficients import Coefficients
from .constants import RADAU, Literal, Radau
from .ellipse import largest_weight, sticking_bound
from .parts import EndParts, StepParts
from .pressed import Pressed

MOST_STEPS = 4000
STACK = 28 << 10  # bytes that a function of a batch may hold in arrays: carom.h promises 32 KiB
MOST_GROWN = 1.5  # logarithm: beyond it a collision is made again, with steps as much more exact
CAREFUL = 1e-8  # budget that steps which are made again have at most: that of their tableau
SQUARINGS = 8  # n of (1 - x/2^n)^(2^n), never above exp(-x), which no freestanding build has
LEAST_STEP = 1e-16  # tolerance of a step, relative to |v1 - v2|, below which all is rounding
DENSE_BELOW = 1e-7  # budget below which a collision ends anywhere in a step
SPIN = 2.5  # R w changes by so much of an impulse: 1 / (2/5) of a ball's inertia
LEAST_TOLERANCE = 0.1
ROUNDED = 2 / 3  # share of the budget that rounding in lanes of floats may come to
NEGLECTED = 0.1  # share of the budget that a step may miss of what it does not look at


def most_in_floats(budget: float) -> int:
    """Steps that a collision may take in lanes of floats: others are left to doubles.

    A step rounds sums of up to 1 by 2^-24, which weighs SPIN in R w and adds up as a random walk:
    four standard deviations of it are ROUNDED of the budget.
    """
    deviation = SPIN * 2.0**-24 / math.sqrt(12)
    return min(MOST_STEPS, int((ROUNDED * budget / (4 * deviation)) ** 2))


@dataclass(frozen=True, kw_only=True)
class ExactContext(LaneRoots, Coefficients, StepParts, EndParts):
    """Numbers and parts of one exact kernel; names as in templates/ball_ball/exact."""

    tableau: Tableau
    control: StepControl
    budget: float
    pressed: Pressed
    tiny_slip: str  # a table slip with a direction, but of no account
    most_steps: int = MOST_STEPS
    most_turns: int = 8  # runs of a collision in which errors grow
    literal: type[Literal] = Literal
    reach: float = 0.65  # what `Declared` says of kReach and kLittleBounce
    little_bounce: float = 0.001
    radau: Radau = RADAU
    no_press: str = "1e-17"  # c_z over c_x up to which no ball is pressed
    no_approach: str = "1e-140"  # v_n over other speeds up to which all is lost in rounding
    slowest: str = "1e-290"  # m/s
    most_slip: str = "1e18"  # scaled: its square is a float
    most_turned: str = "1e7"  # contact slip over approach velocity: both are floats
    huge: str = "1e30"
    tiny_error: float = 1e-72  # far below every square of an error
    no_friction: float = 1e-30  # u_b up to this is none
    tiny_friction: float = 1e-36  # added to u_b where it is divided by; it moves nothing
    scaled: bool = True  # are speeds scaled (they are where they may be any)?
    one_table: bool = False  # is table friction the same for both balls?
    careful: ExactContext | None = None  # where the table drives its slip on: for what grows
    again: bool = False  # is it this one, whose tolerance is less, the more errors grow?
    other: ExactContext | None = None  # unequal masses: as this one (ball 2 pressed), for ball 1
    masses_given: bool = False  # with the call?
    width: int = 1
    lane_bytes: int = 8  # of a vector in flight
    together: int = 1  # vectors whose steps are made at once
    batch: ExactContext | None = None  # the same in lanes
    entry: str = "collide_all"  # what a batch of lanes is called by

    @property
    def most_grown(self) -> float:
        """Logarithm of what the table may make of an error before a collision is made again."""
        return MOST_GROWN

    @property
    def most_ever(self) -> float:
        """The same, where the tolerance of a step would be below rounding."""
        turns = 2**SQUARINGS
        share = LEAST_STEP / (self.control.tolerance * self.budget)
        return _figures(MOST_GROWN + turns * (1 - share ** (1 / turns)))

    @property
    def squarings(self) -> int:
        """By which `shrink` raises what tolerances are multiplied by."""
        return SQUARINGS

    @property
    def most_aim(self) -> float:
        """Of the usual tolerance: that of steps which are made again is at most this."""
        return _figures(min(1.0, CAREFUL / self.budget))

    @property
    def flight_fields(self) -> tuple[str, ...]:
        """What a collision holds between two steps, as exact/flight.j2 has it."""
        start = ("v_n", "u_b", "u_s", "per_u_b")
        state = (
            *self.slip_names,
            "tolerance",
            "q",
            "v",
            "work",
            "target",
            "rest",
            "h_cap",
            "tail_cap",
            "driven",
            *(("grown",) if self.drives else ()),
        )
        added_up = self.results[:-1] if self.gains else ()
        return (
            *(f"start.{name}" for name in start),
            *(f"at.{name}" for name in (*state, *added_up)),
            *(f"at.k.{name}" for name in self.impulse_names),
            "slot",
            "turns",
        )

    @property
    def wave(self) -> int:
        """Vectors under way in a batch: as many as the stack has room for between two waves."""
        room = STACK // (2 * len(self.flight_fields) * self.lane_bytes)
        return max(1, min(6, room - 2))

    @property
    def groups(self) -> int:
        """Vectors of collisions that may wait for those of them that take long."""
        lanes = self.lane_bytes // (4 if self.real == "float" else 8)
        kept = len(self.results) * self.lane_bytes + 16 * lanes  # and status, distance in double
        kept += 24  # where it is in the batch, how much of it is left, its number in two lists
        return STACK // kept

    @property
    def results(self) -> tuple[str, ...]:
        """What is left of the state where a collision ends: velocities follow from it."""
        gains = tuple(f"gain_{name}" for name in self.impulse_names)
        return (*(gains if self.gains else self.slip_names), "q")

    @property
    def aside_fields(self) -> tuple[str, ...]:
        """The same for one that is put aside to stick."""
        own = ("l_c", "at_rest")
        return (*(f"flight.{name}" for name in self.flight_fields), *own)

    @property
    def table(self) -> bool:
        """Does the table act?"""
        return "s_x" in self.slip_names

    @property
    def scalar(self) -> bool:
        """One lane: what rarely happens is branched on, not selected."""
        return self.width == 1

    @property
    def root_of_order(self) -> int:
        """64 / order: `power` takes roots in 64ths."""
        return round(64 / self.tableau.order)

    @property
    def tolerance(self) -> str:
        """Of a step, relative to |v1 - v2|."""
        return decimal_product(self.control.tolerance, self.budget)

    @property
    def spent(self) -> float:
        """Of a step's error, by which the tolerance of the next is less: all make E at most."""
        return self.control.tolerance

    @property
    def least_tolerance(self) -> float:
        """Of the first step's, what any step has: errors that add up leave it."""
        return LEAST_TOLERANCE

    @property
    def drives(self) -> bool:
        """Does table friction drive the table slip on?"""
        return self.pressed.drives

    @property
    def rest_share(self) -> float:
        """Table slip that counts as zero, in tolerances / friction; it matters where it grows."""
        return self.control.rest * (0.03 if self.drives else 1)

    @property
    def settled_share(self) -> float:
        """Table slip that is taken away where it counts as zero, in tolerances."""
        return _figures(5 * self.control.rest)

    @property
    def of_account(self) -> float:
        """Friction on the table, in tolerances, below which a step need not mind where s passes.

        Unseen it makes at most NEGLECTED of the budget, whichever way a step's weights turn it.
        """
        return _figures(NEGLECTED / (SPIN * largest_weight(self.tableau) * self.control.tolerance))

    @property
    def gone(self) -> float:
        """Contact slip, in tolerances, that is taken away at once: SPIN / k_z of it is an error."""
        return _figures(NEGLECTED / 10 / self.control.tolerance)

    @property
    def tail_unseen(self) -> float:
        """What the step into sticking may miss, over u_s |c_z|, where s passes zero within it."""
        return _figures(SPIN * sticking_bound(self.tableau)[0] / self.pressed.least_k_z)

    @property
    def tail_work(self) -> float:
        """What the step into sticking may miss of its work, over twice its embedded errors."""
        return _figures(0.5 * self.tableau.work_share)

    @property
    def landing_turns(self) -> int:
        """Newton iterations for the end of a collision on an interpolant, where it takes any."""
        return 4 if self.dense_landing else 2

    @property
    def dense_landing(self) -> bool:
        """Is the end taken anywhere in a step, on its dense interpolant? Else near its end."""
        return self.again or self.budget < DENSE_BELOW

    @property
    def extend(self) -> float:
        """How far beyond a step's end its interpolant may end the collision, in steps."""
        return 5e-4 if self.dense_landing else 0.05

    @property
    def inside(self) -> float:
        """How far before a step's end the cubic interpolant may end the collision."""
        return 1.0 if self.dense_landing else 0.05 if self.budget < 1e-5 else 0.1

    @property
    def dense_crossing(self) -> bool:
        """Is v_n = 0 found on the dense interpolant?"""
        return self.again or self.budget < 3e-4

    @property
    def crossing_turns(self) -> int:
        """The same for v_n = 0. The work is stationary there: half the digits are enough."""
        return 3 if self.dense_landing else 1

    @property
    def interpolant(self) -> str:
        """t (whole + u (r3 + t (r4 + u (r5 + t (r6 + ...))))), u = 1 - t."""
        text = ""
        for n in reversed(range(len(self.tableau.dense))):
            inner = f"fma({text}, r{n + 5})" if text else f"r{n + 5}"
            text = f"{'t' if n % 2 else 'u'}, {inner}"
        return f"t * fma(u, fma(t, fma({text}, lower.r4), lower.r3), lower.whole)"

    @property
    def counts(self) -> OperationCounts:
        return self.step.counts


def _figures(value: float) -> float:
    """To three figures: more would say more than is known."""
    return float(f"{value:.3g}")
