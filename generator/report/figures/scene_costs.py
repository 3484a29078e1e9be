"""What knowing a scene saves: its exact kernel beside that of scene `any`, on the same cases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...choice.candidates import contest_for, default_kernel
from ...choice.kernel import Emitted, Rejected, Verified
from ...choice.workbench import Workbench
from ...errors import KernelError
from ...evidence.profiling.counting import Counted, count_operations
from ...evidence.timing.plan import PlannedKernel, TimingPlan
from ...evidence.timing.ratios import Speed, timing_results
from ...evidence.verification.errors import Array
from ...impacts.registry import DEFAULT, find_impact
from ...registry.question import Goal
from ...registry.rules import broken_rule
from ...registry.variant import Variant
from ...targets.target import Target
from ...toolchain.flags import compile_flags

COUNTED_CASES = 512
_ROUNDS = 1000
PLAIN = "any"


@dataclass(frozen=True)
class SceneCost:
    """One scene's kernel, and that of `any` with the same options and budget on its cases."""

    scene: str
    budget: float
    step: int  # flops of a step, or of the closed form; an FMA counts as two
    step_any: int
    collision: Counted
    collision_any: Counted
    speed: Speed  # its ratio is to that of `any`
    ns_any: float

    @property
    def flops_ratio(self) -> float:
        return self.collision.flops_per_collision / self.collision_any.flops_per_collision


def kernel_of(target: Target, scene: str, budget: float) -> Variant:
    """The kernel that is compared: the default one, with estimated roots where the target has any.

    Roots are of one Newton step for budgets from 1e-6 on, where the rules allow that.
    """
    model = find_impact(DEFAULT).find_scene(scene).model
    made = default_kernel(contest_for(target, scene, model, Goal(budget=budget)))
    quick = made.with_options(root="est1")
    return quick if budget >= 1e-6 and broken_rule(quick, target) is None else made


def scene_costs(
    bench: Workbench, target: Target, names: Sequence[str], seconds: float
) -> list[SceneCost]:
    """The cost of each scene; `seconds` of timing for each.

    Raises KernelError where a kernel does not build or is not exact enough: nothing is timed that
    was not verified.
    """
    return [_cost(bench, target, name, seconds) for name in names]


def _cost(bench: Workbench, target: Target, name: str, seconds: float) -> SceneCost:
    scene = find_impact(DEFAULT).find_scene(name)
    own = kernel_of(target, name, scene.max_error)
    plain = own.moved(scene=PLAIN)
    candidates = [_verified(bench, variant, target) for variant in (own, plain)]
    cases = bench.cases.timed(name, scene.model)
    counted, counted_any = (_counted(bench, each, target, cases) for each in candidates)
    kernels = tuple(PlannedKernel(c.variant.scene, c.library.path) for c in candidates)
    bench.progress(f"timing scene {name} for {seconds:.0f} s", 0, 1)
    run = bench.tool.time(TimingPlan(cases, kernels, PLAIN, rounds=_ROUNDS, seconds=seconds))
    times = {result.name: result for result in timing_results(run)}
    step, step_any = (candidate.source.counts.flops for candidate in candidates)
    return SceneCost(
        name,
        scene.max_error,
        step,
        step_any,
        counted,
        counted_any,
        times[name],
        times[PLAIN].ns,
    )


def _verified(bench: Workbench, variant: Variant, target: Target) -> Verified:
    made = bench.verify(bench.built(variant, target))
    if isinstance(made, Rejected):
        raise KernelError(f"{made.name}: {made.text}")
    return made


def _counted(bench: Workbench, candidate: Emitted, target: Target, cases: Array) -> Counted:
    flags = compile_flags(candidate.variant, candidate.compiler, target)
    return count_operations(
        candidate.source,
        candidate.compiler,
        flags,
        cases[:COUNTED_CASES],
        bench.cache / "kernels",
    )
