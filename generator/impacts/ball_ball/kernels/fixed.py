"""What the fixed-step scheme gives to a kernel of two balls."""

from __future__ import annotations

from dataclasses import dataclass

from ....errors import InputError
from ....lowering import isa
from ....lowering.counts import OperationCounts
from ....registry.variant import Variant
from ....targets.target import Target
from .. import words
from ..models import find_model
from ..scene import find_scene
from ..steppers.fixed.batch import fixed_step_batch
from ..steppers.fixed.loop import Loop
from ..steppers.fixed.loops import LoopBuilder
from ..terms import ContactTerms
from .parts import KernelParts, lanes_of


@dataclass(frozen=True)
class FixedStepContext:
    """Loops and helpers of one fixed-step kernel, in templates/ball_ball/fixed_step called `e`."""

    variant: Variant
    steps: int
    functions: tuple[Loop, ...]
    helpers: tuple[str, ...]
    lift: bool
    c_z_before: tuple[str, ...]
    estimate: isa.Estimate | None
    rsqrt_call: str
    pair_rsqrt: tuple[str, ...]
    pair_fma: str

    @property
    def chosen(self) -> bool:
        """Is the pressed ball chosen before the loop?"""
        return self.variant["branch"] == "chosen"

    @property
    def scalar_estimate(self) -> bool:
        """Is a scalar root estimated? Lanes that are slips make all of theirs in pairs."""
        return self.variant["simd"] != "slips"

    def fma(self, a: str, b: str, c: str) -> str:
        """a * b + c as this kernel rounds it."""
        placed = self.variant["fma"] == "fma"
        return f"std::fma({a}, {b}, {c})" if placed else f"{a} * {b} + {c}"

    def sum_of_squares(self, a: str, b: str) -> str:
        return self.fma(a, a, f"{b} * {b}")

    def pair_sum_of_squares(self, a: str, b: str) -> str:
        if self.pair_fma:
            return f"fma_pair({a}, {a}, {b} * {b})"
        return f"{a} * {a} + {b} * {b}"


def fixed_step_parts(variant: Variant, target: Target) -> KernelParts:
    """Templates and loops of a fixed-step kernel. InputError where its scene has none."""
    scene = find_scene(variant.scene)
    if not scene.fixed_steps:
        raise InputError(f"--scene {scene.name}: {words.NO_FIXED_STEPS}")
    terms = find_model(variant.model).terms
    context = _context(variant, target, terms, scene.level)
    lanes = lanes_of(variant, target)
    counts = next((f for f in context.functions if f.pressed), context.functions[0]).counts()
    return KernelParts(
        core_template="ball_ball/fixed_step/core.j2",
        batch_template="ball_ball/fixed_step/batch.j2",
        counts=counts,
        contract=_contract(context.steps, counts),
        shown={"e": context, "b": fixed_step_batch(variant, terms, lanes) if lanes else None},
        lanes=lanes,
        vector_frame=variant["simd"] == "prepost",
    )


def _context(
    variant: Variant, target: Target, terms: ContactTerms, level: bool
) -> FixedStepContext:
    builder = LoopBuilder(variant, terms)
    method, in_pairs = variant["rsqrt"], variant["simd"] in ("balls", "slips")
    newton = int(method[-1]) if method.startswith("est") else 0
    only_level = level and variant["branch"] == "chosen"  # no root is taken there
    return FixedStepContext(
        variant=variant,
        steps=variant.stepper.steps or 0,
        functions=tuple(builder.loops(level)),
        helpers=() if only_level else _helpers(variant),
        lift=terms.lift,
        c_z_before=tuple(builder.low.slips_of_contact(only=("c_z",))),
        estimate=isa.estimate(target, newton) if newton else None,
        rsqrt_call=f"rsqrt_newton{newton}" if newton else "exact_rsqrt",
        pair_rsqrt=isa.pair_root(target, method) if in_pairs else (),
        pair_fma=isa.pair_fma(target) if in_pairs and variant["fma"] == "fma" else "",
    )


def _contract(steps: int, counts: OperationCounts) -> tuple[str, ...]:
    return (
        f"Stepper: Euler, N = {steps} steps; error against the vanishing step "
        "about 1/N of the relative speed, up to 1e-3 of it in hard cases at N = 1000.",
        f"Operations an iteration: {counts.describe()} ({counts.flops} flops).",
    )


def _helpers(variant: Variant) -> tuple[str, ...]:
    rsqrt, chosen = variant["rsqrt"], variant["branch"] == "chosen"
    wanted = {
        "exact_rsqrt": rsqrt != "div" or chosen,
        "estimate": rsqrt in ("est1", "est2"),
        "refined": rsqrt in ("prev", "ahead"),
        "masked": variant["branch"] == "bitmask",
        "pair": variant["simd"] in ("balls", "slips"),
        "progress": chosen,
    }
    return tuple(f"ball_ball/fixed_step/helpers/{name}.j2" for name, is_ in wanted.items() if is_)
