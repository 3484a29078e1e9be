"""How an exact kernel's context is made: from its equations, its scene and its recipe."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .....lowering.lane_roots import Wanted, lane_roots
from .....registry.lane_numbers import precision_of
from .....registry.variant import Stepper, Variant
from .....steppers.budgets import BudgetPlan, plan_for
from .....targets.target import Target
from ...masses import GIVEN_PRESSED, Masses, masses_of, pressed_changes
from ...reduced import drives_its_slip
from ...scene import Scene
from ...terms import ContactTerms
from ..collision_ends import CollisionEnds, at_zero
from .coefficients import coefficients
from .context import DENSE_BELOW, MOST_STEPS, ExactContext, most_in_floats
from .parts import Writes, end_parts, step_parts
from .pressed import Pressed
from .step import ExactLowering
from .writing import Equations, Writing

CAREFUL_STEPPER = Stepper("dop853", budget=1e-11)  # of which those have the constants (budgets.py)


@dataclass(frozen=True)
class _Kernel:
    """What a context is of: ball 2 pressed, or where the masses are swapped, ball 1."""

    variant: Variant
    scene: Scene
    terms: ContactTerms
    target: Target
    masses: Masses
    lanes: bool = False

    @property
    def real(self) -> str:
        return precision_of(self.variant) if self.lanes else self.scene.precision

    @property
    def floats(self) -> bool:
        return self.real == "float"

    @property
    def fma(self) -> bool:
        return self.variant["fma"] == "fma"

    @property
    def root(self) -> str:
        return self.variant["lane_root" if self.lanes else "root"]

    @property
    def plan(self) -> BudgetPlan:
        budget, name = self.variant.stepper.budget, self.variant.stepper.name
        if budget is None:
            raise ValueError(f"{name} has no error budget: it is no exact stepper")
        return plan_for(budget, name, drives_its_slip(self.terms))

    @property
    def scaled(self) -> bool:
        """Squares of doubles need no scale where speeds are bounded; floats take any speeds."""
        return not self.scene.bounded or (self.lanes and self.floats)

    @property
    def most_steps(self) -> int:
        """Of a collision; in lanes of floats as many as their rounding allows."""
        leaves = self.lanes and self.floats and self.scene.precision == "double"
        return most_in_floats(self.plan.budget) if leaves else MOST_STEPS


def exact_context(
    variant: Variant, scene: Scene, terms: ContactTerms, target: Target
) -> ExactContext:
    """Decide everything that an exact kernel's templates show."""
    masses = GIVEN_PRESSED if scene.masses_given else masses_of(scene.mass_ratio)
    kernel = _Kernel(variant, scene, terms, target, masses)
    context = _single_context(kernel)
    if variant.width > 1:
        return replace(context, batch=_pressed_context(replace(kernel, lanes=True)))
    if masses.equal or scene.masses_given or not scene.table_friction or scene.level:
        return context
    return replace(context, other=_single_context(replace(kernel, masses=masses.swapped())))


def _single_context(kernel: _Kernel) -> ExactContext:
    """Of one lane; where the table drives its slip on, with the stepper for errors that grow."""
    # One system holds of given masses, whichever ball is pressed.
    scene = kernel.scene
    context = replace(_pressed_context(kernel), masses_given=scene.masses_given)
    if not context.table or not context.drives or scene.level:
        return context
    exactly = kernel.variant.with_options(root="ieee").with_stepper(CAREFUL_STEPPER)
    doubles = scene.model_copy(update={"precision": "double"})
    careful = _pressed_context(replace(kernel, variant=exactly, scene=doubles))
    own = replace(careful, budget=context.budget, again=True, masses_given=scene.masses_given)
    return replace(context, careful=own)


def _pressed_context(kernel: _Kernel) -> ExactContext:
    """As exact_context, for one pressed ball."""
    variant, scene, lanes, floats = kernel.variant, kernel.scene, kernel.lanes, kernel.floats
    plan, table = kernel.plan, scene.table_friction
    wanted = Wanted(lanes, powers=table, roots=table or bool(plan.tableau.second))
    roots = lane_roots(kernel.root, kernel.target, kernel.real, wanted)
    pressed = Pressed.of(pressed_changes(kernel.terms, kernel.masses))
    gains = floats or plan.budget < 1e-10
    ends = CollisionEnds(
        kernel.terms, masses_of(scene.mass_ratio), at_zero(scene), kernel.fma, lanes
    )
    lowering = ExactLowering(
        Equations(kernel.terms, kernel.masses, table),
        plan.tableau,
        Writing(kernel.fma, gains, lanes, roots.split_roots),
    )
    dense = plan.budget < DENSE_BELOW
    how = Writes(floats, roots.root_newton is None, dense, variant.paired)
    return ExactContext(
        **vars(roots),
        **vars(coefficients(pressed)),
        **vars(step_parts(lowering, pressed, how)),
        **vars(end_parts(ends, scene, kernel.scaled, lanes)),
        tableau=plan.tableau,
        control=plan.control,
        budget=plan.budget,
        pressed=pressed,
        tiny_slip="1e-9" if floats else "1e-15",
        together=2 if variant.paired else 1,
        lane_bytes=variant.width * variant.vectors * (4 if floats else 8) if lanes else 8,
        most_steps=kernel.most_steps,
        tiny_error=1e-36 if floats else 1e-72,
        no_friction=1e-9 if floats else 1e-30,
        tiny_friction=1e-9 if floats else 1e-36,
        scaled=kernel.scaled,
        one_table=scene.one_table,
        width=variant.width if lanes else 1,
    )
