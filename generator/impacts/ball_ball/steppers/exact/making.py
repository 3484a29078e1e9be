"""How an exact kernel's context is made: from its equations, its scene and its recipe."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from .....lowering.isa import Estimate, estimate, float_estimate, root_itself
from .....lowering.printer import ExpressionPrinter, Fma, number
from .....registry.lane_numbers import precision_of
from .....registry.roots import refined_error
from .....registry.variant import Stepper, Variant
from .....steppers.budgets import plan_for
from .....targets.target import Target
from ... import symbols as s
from ...masses import (
    GIVEN_PRESSED,
    Masses,
    masses_of,
    pressed_changes,
)
from ...scene import Scene
from ...terms import ContactTerms, drives_its_slip
from ..collision_ends import CollisionEnds, at_zero
from .context import ExactContext
from .lengths import plan_lines
from .passage import passage_lines
from .pressed import Pressed
from .step import (
    CONTACT,
    IMPULSES,
    RUBBING,
    SLIPS,
    ExactLowering,
)

_DX, _DZ, _DQ = sp.symbols("d_x d_z dq")
_TAIL_DX, _TAIL_DZ, _TAIL_TX, _TAIL_TY = sp.symbols("d_tail_x d_tail_z t_tail_x t_tail_y")
SLIPS_BEFORE = ("c_x", "c_z", "s1x", "s1y", "s2x", "s2y", "v_n")
CAREFUL_STEPPER = Stepper("dop853", budget=1e-11)  # of which those have the constants (budgets.py)


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


def _budget_of(variant: Variant) -> float:
    if variant.stepper.budget is None:
        raise ValueError(f"{variant.stepper.name} has no error budget: it is no exact stepper")
    return variant.stepper.budget


def _pressed_context(
    variant: Variant,
    scene: Scene,
    terms: ContactTerms,
    target: Target,
    masses: Masses,
    lanes: bool = False,
) -> ExactContext:
    """As exact_context, for ball 2 pressed, or where the masses are swapped for ball 1."""
    fma = variant["fma"] == "fma"
    real = precision_of(variant) if lanes else scene.precision
    # Squares of doubles need no scale where speeds are bounded; lanes of floats take any speeds.
    scaled = not scene.bounded or (lanes and real == "float")
    table = scene.table_friction
    changes = pressed_changes(terms, masses)
    k_b, k_f = changes[s.S2Y].coeff(s.D_Z), changes[s.S2X].coeff(s.T2X)
    plan = plan_for(_budget_of(variant), variant.stepper.name, drives_its_slip(terms))
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
