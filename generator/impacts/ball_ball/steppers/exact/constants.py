"""The constants of the step control: each with its unit, its reason and what set it.

What depends on the budget is named here and valued in budgets.py, or computed from the tableau
(ellipse.py). docs/step-control.md shows this table.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from .....lowering.lane_algebra import Fixed, exact
from .....lowering.printer import ExpressionPrinter

PRINTER = ExpressionPrinter(False)
TRIED = "tried, not derived: no measurement of it alone is kept"
BY_BUDGET = "by budget (budgets.py), on the hard and random cases that accuracy.md counts"


@dataclass(frozen=True, eq=False)
class Constant(Fixed):
    """One constant; `form` is its value, or its name where a kernel declares it."""

    unit: str
    reason: str
    measured: str = TRIED

    @property
    def text(self) -> str:
        """As a template shows it."""
        return PRINTER.print(self.form)


def _value(value: float, unit: str, reason: str, measured: str = TRIED) -> Constant:
    return Constant(exact(value), unit, reason, measured)


def _named(name: str, unit: str, reason: str, measured: str = TRIED) -> Constant:
    return Constant(sp.Symbol(name, real=True), unit, reason, measured)


class Declared:
    """What a kernel declares at its top, by the kernel's name for it."""

    tolerance = _named(
        "kTolerance", "|v1 - v2|", "what one step may be off: a share of the budget", BY_BUDGET
    )
    spent = _named(
        "kSpent",
        "1",
        "share of a step's error by which the tolerance of the next is less: that of a step over "
        "the budget, so that what steps are seen to be off by comes to E at most, up to "
        "`kLeastTolerance`",
        "derived",
    )
    least_tolerance = _named(
        "kLeastTolerance",
        "kTolerance",
        "0.1: of the first step's tolerance, what any step has; lanes leave what takes so many "
        "steps to one lane",
    )
    turn = _named("kTurn", "1", "scale of steps by the turning of the contact slip", BY_BUDGET)
    table = _named("kTable", "1", "scale of steps by the distance of s from zero", BY_BUDGET)
    passage = _named("kPassage", "tol", "error that one passage may make", BY_BUDGET)
    depart = _named("kDepart", "tol", "error that the first step from rest may make", BY_BUDGET)
    table_error = _named(
        "kTableError",
        "1",
        "weight of the errors of table friction beside those of contact friction",
        "with 3 the tolerance may be 3 to 4 times as large: passages make the largest errors, "
        "and table friction's error shows them",
    )
    tail = _named("kTail", "1", "weight of the error of a step into sticking", BY_BUDGET)
    counts = _named(
        "kCounts",
        "tol",
        "friction below which a step does not look where s passes: a step misses at most 1 + the "
        "sum of its weights' sizes (2.0 `ss43`, 2.6 `dp54`, 13.9 `dop853`) times phi h, in R w 2.5 "
        "times that; a tenth of E may stay unseen",
        "derived (ellipse.py)",
    )
    gone = _named(
        "kGone",
        "tol",
        "contact slip that is taken away at once: it makes 2.5/k_z of itself, 0.01 E of slip, "
        "0.005 E in R w",
        "derived",
    )
    most_grown = _named(
        "kMostGrown",
        "1",
        "logarithm of the most that the table, where it drives s on, may have made of an error: "
        "beyond it the collision is made again, with steps as much more exact",
        "the share of collisions beyond it, with the time of each",
    )
    tail_unseen = _named(
        "kTailUnseen",
        "1",
        "what a step into sticking may miss at P = 1, over u_s |c_z|: 2.5 C/k_z, with C of the "
        "nodes of that step",
        "derived (ellipse.py); a test holds C against 500 paths off its grid",
    )
    tail_work = _named(
        "kTailWork",
        "1",
        "half of the most that the work of a step into sticking is off by over its two embedded "
        "errors, of q and of itself: 2.5, of `ss43` 0.75",
        "computed for directions of s that stay; a test holds it",
    )
    order = _named("kOrder", "1/64", "64 over the order p: `power` takes 64ths", "exact")
    safe = _named("kSafe", "tol", "errors are aimed at this share of the tolerance")
    reach = _named("kReach", "1", "share of the way to sticking that a step may take: 0.65")
    rest = _named(
        "kRest",
        "tol",
        "table slip times friction that counts as none; 0.03 of it where the table drives s on",
    )
    settled = _named(
        "kSettled",
        "tol",
        "table slip that is taken away where it counts as none: five times kRest, what counts as "
        "none at table friction of 0.2",
        "with it left, `mathavan2014` was off by 2.8 E at 1e-9, by steps of 1000 |s|/|b|",
    )
    extend = _named(
        "kExtend",
        "steps",
        "how far beyond a step its interpolant may end the collision: 0.05 of a cubic or quartic, "
        "5e-4 of order 7",
        "order 7 is off by more than E from about 0.002 on",
    )
    inside = _named("kInside", "steps", "how far before its end a cubic may: 0.1, below 1e-5 0.05")
    little_bounce = _named(
        "kLittleBounce",
        "1",
        "e_b below which order 7 takes restitution's work by parts: 0.001",
        "either formula is good on both sides: they differ by 3 e_b to 6 e_b budgets at 1e-9",
    )
    tiny_square = _named(
        "kTinySquare",
        "(m/s)^2, scaled",
        "1e-36, in floats 1e-24: added to squares of slips, so that no slip has no friction; far "
        "below rounding",
        "not measured",
    )
    tiny_slip = _named(
        "kTinySlip", "m/s, scaled", "1e-15, in floats 1e-9: a slip with a direction, of no account"
    )


class Literal:
    """What stands in a kernel as a number."""

    weighs_spin = _value(
        2.5, "1", "the largest change of R w by an impulse: 1/(2/5), a ball's inertia", "derived"
    )
    reverse = _value(0.1, "1", "the least that a rejected step's length is multiplied by")
    shorter = _value(0.9, "1", "of the length that would just be accepted")
    half_slip = _value(
        0.5, "1", "the most of a contact slip from which sticking is tried again after it failed"
    )
    longer = _value(10, "1", "the most that a step is longer than the one before")
    growth = _value(4, "1", "the same where there is no friction on the table")
    coarse = _value(
        0.01,
        "1",
        "weight of the square of the coarser of two embedded errors beside the finer's: it keeps "
        "chance zeros of the finer from view",
        "the tableau's own",
    )
    close = _value(
        0.1,
        "tol",
        "the square of what v is off by, over a speed: Newton's next step is then below tolerance",
        "derived",
    )
    slow = _value(20, "1", "v over what remains, below which the end is more than one guess away")
    least_share = _value(
        -0.9, "1", "the least share of the change of v_n^2 since v_n = 0 that the table makes"
    )
    most_share = _value(0.6, "1", "and the most")
    off_rest = _value(
        0.7, "|s|/|b|", "share of it that s must come nearer for its path to count as an approach"
    )
    curved = _value(
        0.05, "1", "the turning of c bends the path of s by at most this share of omega d^2/|b|"
    )
    most_passed = _value(20, "|s|/|b|", "the longest step, where table friction hardly counts")
    most_running = _value(0.5, "|s|/|b|", "the same where the table drives s away from zero")
    least_leaving = _value(
        0.01, "phi", "how fast s leaves zero at least, where nothing else would drive it"
    )
    beats = _value(1.1, "1", "a push that beats all else is taken a tenth larger than it is")
    most_grown_at_once = _value(
        0.5, "1", "logarithm of what an error grows by in a step, as far as |s| stays"
    )
    least_apart = _value(
        1e-12, "1", "1/r of a step that passes zero itself", "below errors in what is passed"
    )
    least_length = _value(
        0.99, "1", "of a product of lengths: estimates of roots may be off by 0.4 %", "derived"
    )
    per_octave = _value(
        44.3614195558365,
        "1",
        "64 log(2): x^(1/64) as `power` has it is 1 + log2(x)/64, less at most 0.086/64",
        "derived",
    )
    least_octave = _value(-44.3614195558365, "1", "-64 log(2)", "derived")
    octave = _value(
        -44.3, "1", "-64 log(2), and log(2) 0.086 more: what `power` may lack", "derived"
    )
    settles_near = _value(
        0.7,
        "1",
        "share of what is left of table friction that an error of q turns",
    )
    least_fall = _value(
        0.001, "k_z", "the slowest that c_z falls at, whatever the table does", "derived"
    )
    margin = _value(1.01, "1", "of a bound: for what estimates of inverses are off", "derived")
    away = _value(
        0.6, "|s|/|b|", "s that leaves zero does not matter to a step into sticking shorter than it"
    )
    towards = _value(
        1.5,
        "l_stick",
        "nor does s that approaches zero but would not reach it in this",
    )


@dataclass(frozen=True)
class Radau:
    """Nodes (6 - r)/10, (6 + r)/10 and weights (16 + r)/36, (16 - r)/36, r^2 = 6, to 16 digits."""

    nodes: tuple[str, str]
    weights: tuple[str, str]


RADAU = Radau(
    ("0.35505102572168222", "0.84494897427831778"), ("0.51248582618842160", "0.37640306270046728")
)


def table() -> list[tuple[str, Constant]]:
    """All of them, as name and constant."""
    groups: tuple[type, ...] = (Declared, Literal)
    named = [(name, value) for group in groups for name, value in vars(group).items()]
    return [(name, value) for name, value in named if isinstance(value, Constant)]
