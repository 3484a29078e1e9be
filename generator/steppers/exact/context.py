"""What the templates of the exact steppers may see."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import sympy as sp

from ...impacts.ball_ball import symbols as s
from ...impacts.ball_ball.masses import (
    GIVEN_PRESSED,
    Masses,
    masses_of,
    pressed_changes,
)
from ...impacts.ball_ball.scene import Scene
from ...impacts.ball_ball.terms import ContactTerms, drives_its_slip
from ...lowering.collision_ends import CollisionEnds, LevelForms, at_zero
from ...lowering.counts import OperationCounts
from ...lowering.isa import Estimate, estimate, float_estimate, root_itself
from ...lowering.printer import ExpressionPrinter, Fma, decimal_product, number
from ...lowering.statements import Part
from ...registry.lane_numbers import precision_of
from ...registry.roots import refined_error
from ...registry.variant import Stepper, Variant
from ...tableaus.tableau import Tableau
from ...targets.target import Target
from .budgets import StepControl, plan_for
from .ellipse import largest_weight, sticking_bound
from .lengths import PlanLines, plan_lines
from .passage import PassageLines, passage_lines
from .pressed import Pressed
from .step import (
    CONTACT,
    IMPULSES,
    RUBBING,
    SLIPS,
    ExactLowering,
    ExactStep,
    Kept,
)

MOST_STEPS = 4000
_DX, _DZ, _DQ = sp.symbols("d_x d_z dq")
_TAIL_DX, _TAIL_DZ, _TAIL_TX, _TAIL_TY = sp.symbols("d_tail_x d_tail_z t_tail_x t_tail_y")
STACK = 28 << 10  # bytes that a function of a batch may hold in arrays: carom.h promises 32 KiB
MOST_GROWN = 1.5  # logarithm: beyond it a collision is made again, with steps as much more exact
CAREFUL = 1e-8  # budget that steps which are made again have at most: that of their tableau
CAREFUL_STEPPER = Stepper("dop853", budget=1e-11)  # of which those have the constants (budgets.py)
LEAST_STEP = 1e-16  # tolerance of a step, relative to |v1 - v2|, below which all is rounding
SPIN = 2.5  # R w changes by so much of an impulse: 1 / (2/5) of a ball's inertia
NEGLECTED = 0.1  # share of the budget that a step may miss of what it does not look at
SLIPS_BEFORE = ("c_x", "c_z", "s1x", "s1y", "s2x", "s2y", "v_n")


@dataclass(frozen=True)
class ExactContext:
    """Numbers and parts of one exact kernel; names as in templates/exact."""

    tableau: Tableau
    control: StepControl
    budget: float
    step: ExactStep
    real: str
    lane_estimate: tuple[str, ...]
    root_newton: int | None
    split_roots: bool  # may what a root is multiplied by go in before its last correction?
    root_cubic: bool
    estimates: bool  # is rsqrt_estimate an instruction's, where there is one?
    coarse: bool  # is the estimate so coarse that a root and a division do better than refining it?
    root_text: str
    tiny_square: str
    tiny_slip: str  # a table slip with a direction, but of no account
    before: tuple[str, ...]  # slips from velocities
    relative: tuple[str, ...]  # the components of v1 - v2
    after: tuple[str, ...]  # velocities from impulse sums
    level: LevelForms
    slip_of: dict[
        str, str
    ]  # the table slips, by the names they have, or 0.0 where known to be zero
    k_x: float  # c_x' = k_x d_x + ...
    k_z: str  # c_z' = k_z d_z + ...
    k_zt: str  # c_z' = ... + k_zt t_y
    per_k_x: str  # their inverses, exact but for one rounding
    per_k_z: str
    drift_x: str
    drift_y: str
    tail_t_x: str  # table friction of sticking, as it changes c_x and v_n
    tail_t_y: str
    tail_steps: tuple[str, ...]  # the stages of the step into sticking
    extra_stages: tuple[Part, ...]  # for the interpolant alone
    kept: tuple[Kept, ...]  # what each stage leaves, where two vectors' stages are made in turn
    dense_work: tuple[str, ...]  # coefficients of the interpolants of t_y and of the work
    dense_contact: tuple[str, ...]  # of the other impulses
    plan: PlanLines | None
    passage: PassageLines | None
    drift: tuple[str, ...]  # b, the rate of the table slip
    landed: tuple[str, ...]  # slips from the impulses of a part of a step
    k_xt: str  # c_x' = ... - k_xt t_x
    xt_per_x: str  # k_xt / k_x
    bending: str  # k_x k_zt / k_z
    least_k_z: float  # of all masses that there may be
    k_f: sp.Expr  # s' = ... + k_f t
    approach_share: str  # of table friction in the change of v_n, as a factor
    tail_s_x: str
    tail_s_y: str
    impulse_names: tuple[str, ...] = tuple(IMPULSES)
    slip_names: tuple[str, ...] = tuple(SLIPS)
    most_steps: int = MOST_STEPS
    huge: str = "1e30"
    tiny_error: float = 1e-72  # far below every square of an error
    no_friction: float = 1e-30  # u_b up to this is none
    tiny_friction: float = 1e-36  # added to u_b where it is divided by; it moves nothing
    gains: bool = False  # are changes of slips added up beside them (float, or a tight budget)?
    scaled: bool = True  # are speeds scaled (they are where they may be any)?
    one_table: bool = False  # is table friction the same for both balls?
    careful: ExactContext | None = None  # where the table drives its slip on: for what grows
    again: bool = False  # is it this one, whose tolerance is less, the more errors grow?
    other: ExactContext | None = None  # unequal masses: as this one (ball 2 pressed), for ball 1
    masses_given: bool = False  # with the call?
    tail_bend: str = ""  # the power of 1 - t on the way into sticking, where masses make it
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
        return _figures(MOST_GROWN + math.log(self.control.tolerance * self.budget / LEAST_STEP))

    @property
    def most_aim(self) -> float:
        """Of the usual tolerance: that of steps which are made again is at most this."""
        return _figures(min(1.0, CAREFUL / self.budget))

    @property
    def flight_fields(self) -> tuple[str, ...]:
        """What a collision holds between two steps, as templates/exact/flight.j2 has it."""
        start = ("v_n", "u_b", "u_s", "tolerance", "per_u_b")
        state = (
            *self.slip_names,
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
        own = ("l_c", "rest_error", "at_rest")
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
    def drives(self) -> bool:
        """Does table friction drive the table slip on?"""
        return bool(self.k_f.is_negative)

    @property
    def rest_share(self) -> float:
        """Table slip that counts as zero, in tolerances / friction; it matters where it grows."""
        return self.control.rest * (0.03 if self.drives else 1)

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
        return _figures(SPIN * sticking_bound(self.tableau)[0] / self.least_k_z)

    @property
    def sticking_power(self) -> int:
        return sticking_bound(self.tableau)[1]

    @property
    def landing_turns(self) -> int:
        """Newton iterations for the end of a collision on an interpolant, where it takes any."""
        return 4 if self.dense_landing else 2

    @property
    def dense_landing(self) -> bool:
        """Is the end taken anywhere in a step, on its dense interpolant? Else near its end."""
        return self.again or self.budget < 1e-7

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


def _roots(method: str, target: Target, real: str, lanes: bool) -> tuple[Estimate, int | None, str]:
    def of(target: Target, newton: int) -> Estimate:
        if real == "float":
            return float_estimate(target, newton, lanes)
        return estimate(target, newton)

    if method in ("inv", "ieee"):
        return of(target, 0) if method == "inv" else root_itself(real), None, ""
    rounding = 2.0**-23 if real == "float" else 2.0**-52
    if method == "cubic":
        found = of(target, 0)
        error = max(refined_error(method, found.relative_error), rounding)
        return found, 0, f": {found.text}, then one step of third order, to {error:.0e}"
    steps = int(method[-1])
    found = of(target, steps)
    error = max(refined_error(method, found.relative_error), rounding)
    refined = f", then {steps} Newton" if steps else ""
    return found, steps, f": {found.text}{refined}, to {error:.0e}"


def _printed(form: sp.Expr) -> str:
    return ExpressionPrinter(True, fma_name="fma", number_format="real({})").print(form)


def _figures(value: float) -> float:
    """To three figures: more would say more than is known."""
    return float(f"{value:.3g}")


def _times(share: sp.Expr, text: str) -> str:
    factor = _printed(share)
    return text if share == 1 else f"({factor}) * {text}" if share.is_Add else f"{factor} * {text}"


def _value(form: sp.Expr) -> str:
    """As a literal, or in masses that are given with the call."""
    return repr(float(form)) if form.is_number else _printed(form)


def _over(top: sp.Expr, bottom: sp.Expr) -> str:
    """A quotient as `_value`; of numbers as doubles divide them."""
    if top.is_number and bottom.is_number:
        return repr(float(top) / float(bottom))
    return _printed(sp.cancel(top / bottom))


def exact_context(
    variant: Variant, scene: Scene, terms: ContactTerms, target: Target
) -> ExactContext:
    """Decide everything that an exact kernel's templates show."""
    masses = GIVEN_PRESSED if scene.masses_given else masses_of(scene.mass_ratio)
    context = _single_context(variant, scene, terms, target, masses)
    if variant.width > 1:
        return replace(context, batch=_pressed_context(variant, scene, terms, target, masses, True))
    if masses.equal or scene.masses_given or not scene.table_friction or scene.level:
        return context
    return replace(context, other=_single_context(variant, scene, terms, target, masses.swapped()))


def _single_context(
    variant: Variant, scene: Scene, terms: ContactTerms, target: Target, masses: Masses
) -> ExactContext:
    """Of one lane; where the table drives its slip on, with the stepper for errors that grow."""
    # One system holds of given masses, whichever ball is pressed.
    context = _pressed_context(variant, scene, terms, target, masses)
    context = replace(context, masses_given=scene.masses_given)
    if not context.table or not context.drives or scene.level:
        return context
    exactly = variant.with_options(root="ieee").with_stepper(CAREFUL_STEPPER)
    doubles = scene.model_copy(update={"precision": "double"})
    careful = _pressed_context(exactly, doubles, terms, target, masses)
    own = replace(careful, budget=context.budget, again=True, masses_given=scene.masses_given)
    return replace(context, careful=own)


def _pressed_context(
    variant: Variant,
    scene: Scene,
    terms: ContactTerms,
    target: Target,
    masses: Masses,
    lanes: bool = False,
) -> ExactContext:
    """As exact_context, for ball 2 pressed, or where the masses are swapped for ball 1."""
    assert variant.stepper.budget is not None
    fma = variant["fma"] == "fma"
    real = precision_of(variant) if lanes else scene.precision
    # Squares of doubles need no scale where speeds are bounded; lanes of floats take any speeds.
    scaled = not scene.bounded or (lanes and real == "float")
    table = scene.table_friction
    changes = pressed_changes(terms, masses)
    k_b, k_f = changes[s.S2Y].coeff(s.D_Z), changes[s.S2X].coeff(s.T2X)
    plan = plan_for(variant.stepper.budget, variant.stepper.name, drives_its_slip(terms))
    drive, recoil = changes[s.S2Y].coeff(s.DQ), -changes[s.S2X].coeff(s.D_X)
    k_x, k_xt = changes[s.C_X].coeff(s.D_X), -changes[s.C_X].coeff(s.T2X)
    k_z, k_zt = changes[s.C_Z].coeff(s.D_Z), changes[s.C_Z].coeff(s.T2Y)
    root = variant["lane_root" if lanes else "root"]
    found, newton, text = _roots(root, target, real, lanes)
    ends = CollisionEnds(terms, masses_of(scene.mass_ratio), at_zero(scene), fma, lanes)
    floats = real == "float"
    pressed = Pressed.of(changes)
    gains = floats or plan.budget < 1e-10
    slips: tuple[str, ...] = SLIPS_BEFORE if table else ("c_x", "c_z", "v_n")
    resting = ("s2x", "s2y") if scene.object_ball == "rest" else ()
    if scene.level:
        slips = ("c_x", "v_n")
    split_roots = table and not lanes and bool(newton or root == "cubic")
    lowering = ExactLowering(terms, plan.tableau, fma, masses, table, gains, lanes, split_roots)
    return ExactContext(
        tableau=plan.tableau,
        control=plan.control,
        budget=plan.budget,
        step=lowering.parts(),
        real=real,
        lane_estimate=found.scalar,
        root_newton=newton,
        root_cubic=root == "cubic",
        split_roots=split_roots,
        coarse=found.relative_error > 1e-3 or root == "ieee",
        estimates=root != "ieee",
        root_text=text,
        tiny_square="1e-24" if floats else "1e-36",
        tiny_slip="1e-9" if floats else "1e-15",
        before=ends.slips(n for n in slips if n not in resting).lines,
        relative=ends.relative("per_scale" if scaled else "").lines,
        after=(ends.velocities() if table else ends.free_velocities()).lines,
        level=ends.level(),
        slip_of={
            n: ("real(0.0)" if lanes else "0.0") if n in resting else n
            for n in ("s1x", "s1y", "s2x", "s2y")
        },
        k_x=float(k_x),
        k_z=_value(k_z),
        k_zt=_value(k_zt),
        per_k_x=number(1 / k_x),
        per_k_z=_value(1 / k_z),
        drift_x=_printed(-recoil * _DX),
        drift_y=_printed(Fma(k_b, _DZ, drive)),
        tail_s_x=_printed(Fma(k_f, _TAIL_TX, -recoil * _TAIL_DX)),
        tail_s_y=_printed(Fma(k_f, _TAIL_TY, Fma(k_b, _TAIL_DZ, drive * _DQ))),
        tail_steps=lowering.tail().lines if table else (),
        kept=lowering.kept() if lanes and variant.paired else (),
        together=2 if variant.paired else 1,
        lane_bytes=variant.width * variant.vectors * (4 if floats else 8) if lanes else 8,
        extra_stages=lowering.extra_stages() if table else (),
        dense_work=lowering.dense(("t_y", "j")).lines if table else (),
        dense_contact=lowering.dense(("d_x", "d_z", "t_x")).lines if table else (),
        plan=plan_lines(pressed, lowering.drift().lines, floats) if table else None,
        passage=passage_lines(pressed) if table else None,
        drift=lowering.drift().lines if table else (),
        landed=lowering.landed().lines if table else (),
        k_xt=_value(k_xt),
        xt_per_x=_over(k_xt, k_x),
        bending=_over(k_x * k_zt, k_z),
        least_k_z=pressed.least_k_z,
        tail_bend="" if lowering.tail_bend.is_number else _printed(lowering.tail_bend),
        k_f=k_f,
        approach_share=_times(changes[s.V_N].coeff(s.T2Y), ""),
        tail_t_x=_times(-changes[s.C_X].coeff(s.T2X), "t_tail_x"),
        tail_t_y=_times(changes[s.V_N].coeff(s.T2Y), "t_tail_y"),
        slip_names=tuple(SLIPS) if table else CONTACT,
        impulse_names=tuple(IMPULSES) if table else RUBBING,
        tiny_error=1e-36 if floats else 1e-72,
        no_friction=1e-9 if floats else 1e-30,
        tiny_friction=1e-9 if floats else 1e-36,
        gains=gains,
        scaled=scaled,
        one_table=scene.one_table,
        width=variant.width if lanes else 1,
    )
