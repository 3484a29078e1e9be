"""What the templates of the exact steppers may see."""

from __future__ import annotations

from dataclasses import dataclass, replace

from generator.emission.isa import Estimate, estimate, float_estimate
from generator.lowering.collision_ends import CollisionEnds, LevelForms, at_zero
from generator.lowering.counts import OperationCounts
from generator.lowering.exact_step import CONTACT, RATES, SLIPS, ExactLowering, ExactStep
from generator.lowering.fixed_step import Part
from generator.lowering.printer import number
from generator.mechanics import symbols as s
from generator.mechanics.contact import ContactTerms
from generator.mechanics.masses import Masses, masses_of, pressed_changes
from generator.scenes.scene import Scene
from generator.steppers.budgets import StepControl, plan_for
from generator.steppers.tableaus import Tableau
from generator.targets.target import Target
from generator.variants.variant import Variant

MOST_STEPS = 4000
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
    root_cubic: bool
    root_text: str
    tiny_square: str
    before: tuple[str, ...]  # slips from velocities
    relative: tuple[str, ...]  # the components of v1 - v2
    after: tuple[str, ...]  # velocities from impulse sums
    level: LevelForms
    slip_of: dict[
        str, str
    ]  # the table slips, by the names they have, or 0.0 where known to be zero
    k_x: float  # c_x' = k_x d_x + ...
    k_z: float  # c_z' = k_z d_z + ...
    k_zt: float  # c_z' = ... + k_zt t_y
    drift_x: str
    drift_y: str
    tail_t_x: str  # table friction of sticking, as it changes c_x and v_n
    tail_t_y: str
    tail_steps: tuple[str, ...]  # the stages of the step into sticking
    extra_stages: tuple[Part, ...]  # for the interpolant alone
    dense_work: tuple[str, ...]  # coefficients of the interpolants of v_n and of the work
    dense_slips: tuple[str, ...]
    k_xt: float  # c_x' = ... - k_xt t_x
    k_f: float  # s' = ... + k_f t
    approach_share: str  # of table friction in the change of v_n, as a factor
    tail_s_x: str
    tail_s_y: str
    rate_names: tuple[str, ...] = RATES
    slip_names: tuple[str, ...] = tuple(SLIPS)
    most_steps: int = MOST_STEPS
    huge: str = "1e30"
    tiny_move: float = 4e-16
    tiny_error: float = 1e-72  # far below every square of an error
    no_friction: float = 0.0  # u_b up to this is none
    tiny_friction: float = 1e-36  # added to u_b where it is divided by; it moves nothing
    gains: bool = False  # are changes of slips added up beside them (float)?
    scaled: bool = True  # are speeds scaled (they are where they may be any)?
    one_table: bool = False  # is table friction the same for both balls?
    other: ExactContext | None = None  # unequal masses: as this one (ball 2 pressed), for ball 1
    width: int = 1

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
    def k_f_negative(self) -> float:
        return min(self.k_f, 0.0)

    @property
    def passage_share(self) -> float:
        """Where table friction drives s away from zero, a passage must be met more closely."""
        return self.control.top_passage if self.k_f < 0 else 1.0

    @property
    def depart_share(self) -> float:
        """The same for the first step from rest."""
        return self.control.top_depart if self.k_f < 0 else 1.0

    @property
    def landing_turns(self) -> int:
        """Newton iterations for the end on an interpolant; each gains two to four digits."""
        return 1 if self.budget >= 1e-5 else 2 if self.budget >= 1e-7 else 4

    @property
    def crossing_turns(self) -> int:
        """The same for v_n = 0, where the work is stationary: half the digits are enough."""
        return 0 if self.budget >= 1e-5 else 1 if self.budget >= 1e-7 else 3

    @property
    def interpolant(self) -> str:
        """t (whole + u (r3 + t (r4 + u (r5 + t (r6 + ...))))), u = 1 - t."""
        text = ""
        for n in reversed(range(len(self.tableau.dense))):
            inner = f"fma({text}, r{n + 5})" if text else f"r{n + 5}"
            text = f"{'t' if n % 2 else 'u'}, {inner}"
        r4 = f"fma({text}, r4)" if text else "r4"
        return f"t * fma(u, fma(t, {r4}, r3), whole)"

    @property
    def counts(self) -> OperationCounts:
        return self.step.counts


def _roots(variant: Variant, target: Target, real: str) -> tuple[Estimate, int | None, str]:
    method = variant["root"]
    of = float_estimate if real == "float" else estimate
    if method == "inv":
        return of(target, 0), None, ""
    rounding = 2.0**-23 if real == "float" else 2.0**-52
    if method == "cubic":
        found = of(target, 0)
        error = max(2.5 * found.relative_error**3, rounding)
        return found, 0, f": {found.text}, then one step of third order, to {error:.0e}"
    steps = int(method[-1])
    found = of(target, steps)
    error = found.relative_error
    for _ in range(steps):
        error = 1.5 * error * error
    refined = f", then {steps} Newton" if steps else ""
    return found, steps, f": {found.text}{refined}, to {max(error, rounding):.0e}"


def _times(share: object, text: str) -> str:
    return text if share == 1 else f"real({number(share)}) * {text}"


def exact_context(
    variant: Variant, scene: Scene, terms: ContactTerms, target: Target
) -> ExactContext:
    """Decide everything that an exact kernel's templates show."""
    masses = masses_of(scene.mass_ratio)
    context = _pressed_context(variant, scene, terms, target, masses)
    if masses.equal or not scene.table_friction or scene.level:
        return context
    return replace(context, other=_pressed_context(variant, scene, terms, target, masses.swapped()))


def _pressed_context(
    variant: Variant, scene: Scene, terms: ContactTerms, target: Target, masses: Masses
) -> ExactContext:
    """As exact_context, for ball 2 pressed, or where the masses are swapped for ball 1."""
    assert variant.stepper.budget is not None
    plan = plan_for(variant.stepper.budget, variant.stepper.name)
    fma = variant["fma"] == "fma"
    real, table = scene.precision, scene.table_friction
    changes = pressed_changes(terms, masses)
    k_b, k_f = changes[s.S2Y].coeff(s.D_Z), changes[s.S2X].coeff(s.T2X)
    drive, recoil = changes[s.S2Y].coeff(s.DQ), -changes[s.S2X].coeff(s.D_X)
    k_z = float(changes[s.C_Z].coeff(s.D_Z))
    found, newton, text = _roots(variant, target, real)
    ends = CollisionEnds(terms, masses_of(scene.mass_ratio), at_zero(scene), fma)
    gains = real == "float"
    slips = SLIPS_BEFORE if table else ("c_x", "c_z", "v_n")
    resting = ("s2x", "s2y") if scene.object_ball == "rest" else ()
    if scene.level:
        slips = ("c_x", "v_n")
    lowering = ExactLowering(terms, plan.tableau, fma, masses, table, gains)
    return ExactContext(
        tableau=plan.tableau,
        control=plan.control,
        budget=plan.budget,
        step=lowering.parts(),
        real=real,
        lane_estimate=found.scalar,
        root_newton=newton,
        root_cubic=variant["root"] == "cubic",
        root_text=text,
        tiny_square="1e-24" if gains else "1e-36",
        before=ends.slips(n for n in slips if n not in resting).lines,
        relative=ends.relative("" if scene.bounded else "per_scale").lines,
        after=(ends.velocities() if table else ends.free_velocities()).lines,
        level=ends.level(),
        slip_of={n: "0.0" if n in resting else n for n in ("s1x", "s1y", "s2x", "s2y")},
        k_x=float(changes[s.C_X].coeff(s.D_X)),
        k_z=k_z,
        k_zt=float(changes[s.C_Z].coeff(s.T2Y)),
        drift_x=f"{_times(recoil, '-d_x')}",
        drift_y=f"fma(real({number(k_b)}), d_z, real({number(drive)}))",
        tail_s_x=f"fma(real({number(k_f)}), t_tail_x, {_times(recoil, '-d_tail_x')})",
        tail_s_y=f"fma(real({number(k_f)}), t_tail_y, "
        f"fma(real({number(k_b)}), d_tail_z, {_times(drive, 'dq')}))",
        tail_steps=lowering.tail().lines if table else (),
        extra_stages=lowering.extra_stages() if table else (),
        dense_work=lowering.dense(("t_y", "j")).lines if table else (),
        dense_slips=lowering.dense(tuple(SLIPS)).lines if table else (),
        k_xt=-float(changes[s.C_X].coeff(s.T2X)),
        k_f=float(k_f),
        approach_share=_times(changes[s.V_N].coeff(s.T2Y), ""),
        tail_t_x=_times(-changes[s.C_X].coeff(s.T2X), "t_tail_x"),
        tail_t_y=_times(changes[s.V_N].coeff(s.T2Y), "t_tail_y"),
        slip_names=tuple(SLIPS) if table else CONTACT,
        rate_names=RATES if table else CONTACT,
        tiny_move=1e-6 if gains else 4e-16,
        tiny_error=1e-36 if gains else 1e-72,
        no_friction=1e-9 if gains else 0.0,
        tiny_friction=1e-9 if gains else 1e-36,
        gains=gains,
        scaled=not scene.bounded,
        one_table=scene.one_table,
    )
