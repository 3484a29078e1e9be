"""pooltool's fixed steps of the impulse (pooltool 0.6, `Mathavan2010`), to the last digit.

The order of every sum and product is pooltool's: `Plus`, `Minus` and `Times` keep it as written.
Directions are angles by atan2, whose cosine and sine are taken again, so the C library decides
about the last digits. Spins are angular velocities here, in 1/s, and impulses are in N s.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from ....lowering.counts import OperationCounts
from ....lowering.printer import Divide, ExpressionPrinter, Minus, Negative, Plus, Times
from ....lowering.statements import Assign, Part, lower
from .. import symbols as s
from ..terms import ContactTerms

KIND = "const double"
# The shortest step, pooltool's delta_p in N s: of a collision by default, and of `solve` alone,
# which takes 5000 steps a phase.
LEAST_IMPULSES = ((5000, 1e-4), (1, 1e-3))
MOST_STEPS = 100_000_000
HALVINGS = 8  # of the step that would end compression
PATIENCE = 10  # times max_steps, after which pooltool raises

_VX, _VY, _WX, _WY, _WZ = (sp.Symbol(f"b.{n}", real=True) for n in ("vx", "vy", "wx", "wy", "wz"))
_COS_C, _SIN_C, _COS_S, _SIN_S = (
    sp.Symbol(f"f.{name}", real=True) for name in ("cos_c", "sin_c", "cos_s", "sin_s")
)
_R, _M, _US, _UW = (sp.Symbol(f"p.{name}", real=True) for name in ("R", "M", "u_s", "u_w"))
_DP, _PUSH, _FACTOR = sp.symbols("dp push factor", real=True)
_PER_MASS = sp.Symbol("per_mass", real=True)


@dataclass(frozen=True)
class FixedStepParts:
    """Statements of one step, and the numbers of the scheme."""

    slips: Part  # c_x, c_z, s_x, s_y
    constants: Part  # per_mass, factor
    push: Part
    linear: Part  # vx, vy after
    angular: Part  # wx, wy, wz after
    clamped: bool
    rests: bool  # has a contact without slip no friction?
    ladder: tuple[tuple[int, float], ...] = LEAST_IMPULSES
    most_steps: int = MOST_STEPS
    halvings: int = HALVINGS
    patience: int = PATIENCE

    @property
    def counts(self) -> OperationCounts:
        parts = (self.slips, self.constants, self.push, self.linear, self.angular)
        return sum((part.counts for part in parts), OperationCounts())


def least_impulse(steps: int) -> float:
    """pooltool's delta_p that goes with so many steps."""
    return next(least for count, least in LEAST_IMPULSES if steps >= count)


def _chain(*factors: sp.Expr) -> sp.Expr:
    """A product from the left."""
    product = factors[0]
    for factor in factors[1:]:
        product = Times(product, factor)
    return product


def fixed_step_parts(terms: ContactTerms, place_fma: bool) -> FixedStepParts:
    printer = ExpressionPrinter(place_fma, {"S": "n.sine", "C": "n.cosine"})
    sine, cosine = s.SIN, s.COS

    def part(declares: str, **forms: sp.Expr) -> Part:
        block = lower([Assign(n, form, declares) for n, form in forms.items()], printer)
        return Part(tuple(block.lines), block.counts)

    pull_x, pull_y = _chain(_US, _COS_S, _PUSH), _chain(_US, _SIN_S, _PUSH)
    along, up = Times(_UW, _COS_C), Times(_UW, _SIN_C)
    turned = Negative(_FACTOR)
    against = Plus(Minus(cosine, _chain(_UW, sine, _SIN_C)), pull_y)
    return FixedStepParts(
        slips=part(
            KIND,
            c_x=Minus(Plus(_VX, _chain(_WY, _R, sine)), _chain(_WZ, _R, cosine)),
            c_z=Plus(_chain(Negative(_VY), sine), Times(_WX, _R)),
            s_x=Minus(_VX, Times(_WY, _R)),
            s_y=Plus(_VY, Times(_WX, _R)),
        ),
        constants=part(
            KIND,
            per_mass=Divide(sp.Integer(1), _M),
            factor=Divide(5, _chain(sp.Integer(2), _M, _R)),
        ),
        push=part(KIND, push=Plus(sine, _chain(_UW, _SIN_C, cosine))),
        linear=part(
            KIND,
            vx=Minus(_VX, _chain(_PER_MASS, Plus(along, pull_x), _DP)),
            vy=Minus(_VY, _chain(_PER_MASS, against, _DP)),
        ),
        angular=part(
            KIND,
            wx=Plus(_WX, _chain(turned, Plus(up, pull_y), _DP)),
            wy=Plus(_WY, _chain(turned, Minus(Times(along, sine), pull_x), _DP)),
            wz=Plus(_WZ, _chain(_FACTOR, Times(along, cosine), _DP)),
        ),
        clamped=terms.clamped,
        rests=terms.sticks,
    )


def fixed_step_method(steps: int, counts: OperationCounts) -> tuple[str, ...]:
    """What the contract says of the stepper."""
    return (
        f"Stepper: pooltool's, max_steps {steps} and delta_p {least_impulse(steps):g} N s: of the "
        "first order, a few 1e-3 of the speed off at 1 m/s and without bound below 0.1 m/s.",
        f"Operations a step: {counts.describe()} ({counts.flops} flops), two arc tangents, four "
        "sines and cosines.",
    )
