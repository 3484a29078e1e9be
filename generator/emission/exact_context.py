"""What the templates of the exact steppers may see."""

from __future__ import annotations

from dataclasses import dataclass

from generator.emission.isa import Estimate, estimate
from generator.lowering.counts import OperationCounts
from generator.lowering.exact_step import RATES, SLIPS, ExactLowering, ExactStep
from generator.mechanics import symbols as s
from generator.mechanics.contact import ContactTerms
from generator.mechanics.reduced import reduced_system
from generator.steppers.budgets import StepControl, plan_for
from generator.steppers.tableaus import Tableau
from generator.targets.target import Target
from generator.variants.variant import Variant

MOST_STEPS = 400


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
    root_text: str
    tiny_square: str
    before: tuple[str, ...]
    after: tuple[str, ...]
    k_x: float  # c_x' = k_x d_x + ...
    k_z: float  # c_z' = k_z d_z + ...
    k_f: float  # s' = ... + k_f t
    drift_x: str
    drift_y: str
    tail_speed: float
    tail_s_x: str
    tail_s_y: str
    rate_names: tuple[str, ...] = RATES
    slip_names: tuple[str, ...] = tuple(SLIPS)
    most_steps: int = MOST_STEPS
    huge: str = "1e30"
    width: int = 1

    @property
    def scalar(self) -> bool:
        """One lane: what rarely happens is branched on, not selected."""
        return self.width == 1

    @property
    def slope_inverse(self) -> float:
        return float(1 / (1 - self.tableau.c[self.tableau.slope_stage]))

    @property
    def counts(self) -> OperationCounts:
        return self.step.counts


def _roots(variant: Variant, target: Target) -> tuple[Estimate, int | None, str]:
    method = variant["root"]
    if method == "inv":
        return estimate(target, 0), None, ""
    steps = int(method[-1])
    found = estimate(target, steps)
    error = found.relative_error
    for _ in range(steps):
        error = 1.5 * error * error
    return found, steps, f": {found.text}, then {steps} Newton, to {max(error, 2.0**-52):.0e}"


def exact_context(
    variant: Variant,
    terms: ContactTerms,
    target: Target,
    before: tuple[str, ...],
    after: tuple[str, ...],
) -> ExactContext:
    """Decide everything that an exact kernel's templates show."""
    assert variant.stepper.budget is not None
    plan = plan_for(variant.stepper.budget, variant.stepper.name)
    fma = variant["fma"] == "fma"
    changes = reduced_system(terms, 2).changes
    k_b = float(changes[s.S2Y].coeff(s.D_Z))
    k_f = float(changes[s.S2X].coeff(s.T2X))
    k_z = float(changes[s.C_Z].coeff(s.D_Z))
    found, newton, text = _roots(variant, target)
    return ExactContext(
        tableau=plan.tableau,
        control=plan.control,
        budget=plan.budget,
        step=ExactLowering(terms, plan.tableau, fma).parts(),
        real="double",
        lane_estimate=found.scalar,
        root_newton=newton,
        root_text=text,
        tiny_square="1e-36",
        before=before,
        after=after,
        k_x=float(changes[s.C_X].coeff(s.D_X)),
        k_z=k_z,
        k_f=k_f,
        drift_x="-d_x",
        drift_y=f"fma(real({k_b!r}), d_z, real(1.0))",
        tail_s_x=f"fma(real({k_f!r}), t_tail_x, -d_tail_x)",
        tail_s_y=f"fma(real({k_f!r}), t_tail_y, fma(real({k_b!r}), d_tail_z, dq))",
        tail_speed=0.45 * k_z / 6,
    )
