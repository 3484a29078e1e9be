"""Cycles a collision takes on a CPU that is not here: what ran here, replayed by llvm-mca.

Instructions that real collisions execute are recorded on this machine, or under an emulator where
the target is of another architecture, whatever their loops and branches do, and simulated on the
target. So kernels with few long steps and kernels with many short ones compare, and what stands
around the loop counts.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ..errors import KernelError
from ..evidence.records.code import key_of
from ..evidence.timing.bench_tool import Way
from ..evidence.verification.errors import Array
from ..impacts.impact import Impact
from ..lowering.lanes import lane_context
from ..registry.lane_numbers import precision_of
from ..registry.question import Contest
from ..registry.variant import Variant
from ..targets.target import Target, find_target
from ..toolchain.build import build
from ..toolchain.mca import McaReport, analyse, assembly_of, require_mca
from ..toolchain.replay import REPLAYED, Modelled, replayed_cycles
from ..toolchain.traces import TracedKernel, traced
from .kernel import Emitted, Rejected
from .workbench import Workbench

# Of the mixed set that kernels are timed on. All their steps are recorded: with fewer, longer steps
# other checks fail.
EXACT_CASES = 256
FIXED_CASES = 32
FIXED_CASES_IN_LANES = 64


def model_all(
    bench: Workbench, contest: Contest, kernels: Sequence[Emitted]
) -> dict[str, Modelled | KernelError]:
    """Cycles of each kernel on the contest's target by its name, or why they are not known."""
    target = find_target(contest.target)

    def model_one(kernel: Emitted) -> Modelled | KernelError:
        cases = bench.cases.timed(contest.scene, contest.model, contest.batches)
        try:
            return modelled(bench, kernel, target, cases)
        except KernelError as error:
            return error

    found = bench.each(f"modelling on {target.row.mca_cpu} (llvm-mca)", model_one, kernels)
    return {k.name: m for k, m in zip(kernels, found, strict=True) if not isinstance(m, Rejected)}


def modelled(bench: Workbench, candidate: Emitted, target: Target, cases: Array) -> Modelled:
    """The mean over the first cases, from the store or made now. Raises KernelError."""
    kernel = {k: v for k, v in candidate.sources.items() if k != "probe.cpp"}
    probe = {"probe.cpp": candidate.sources["probe.cpp"]}
    compiler, flags = candidate.compiler, candidate.flags
    wide = candidate.variant.width > 1
    chosen = _batch_of(cases, candidate.variant.question.row) if wide else cases
    chosen = chosen[: _count(candidate.variant)]

    def make() -> dict[str, Any]:
        library = traced(kernel, probe, compiler, flags, candidate.name, target.row.arch)
        return asdict(replayed(bench, library, target, chosen, wide))

    texts = sorted(candidate.sources.items())
    tools = (compiler.version, flags, require_mca().version, bench.tool.executable.name)
    key = key_of(texts, tools, target.row.mca_cpu, target.row.decoded, chosen, wide, REPLAYED)
    return Modelled(**bench.store.kept("llvm-mca figures", key, make))


def _count(variant: Variant) -> int:
    if variant.stepper.steps is None:
        return EXACT_CASES
    return FIXED_CASES_IN_LANES if variant.width > 1 else FIXED_CASES


def _batch_of(cases: Array, impact: Impact) -> Array:
    """The cases with the parameters of the first but the varied one, as a call of a batch has them.

    Every spin times the radius stays as it is.
    """
    columns, shared = impact.columns, cases.copy()
    radius = columns.parameters.index(columns.radius)
    shared[:, columns.spins] *= cases[:, [radius]] / cases[0, radius]
    kept = [n for n, key in enumerate(columns.parameters) if key != impact.functions.varied]
    shared[:, kept] = cases[0, kept]
    return shared


def replayed(
    bench: Workbench,
    kernel: TracedKernel,
    target: Target,
    cases: Array,
    batch: bool = False,
) -> Modelled:
    """What the kernel's run of the cases takes on the target; `batch`: in one call."""
    library = build(kernel.job, bench.cache / "kernels")
    with tempfile.TemporaryDirectory() as folder:
        trace = Path(folder, "trace")
        runner = bench.emulated or bench.tool
        runner.run_kernel(library.path, cases, batch=batch, way=Way(trace=trace))
        ran = kernel.instructions(trace)
        decoded = kernel.decoded_again(trace, target.row.decoded)
    return Modelled(
        cpu=target.row.mca_cpu,
        cycles=replayed_cycles(ran, target, decoded) / len(cases),
        instructions=len(ran) / len(cases),
        cases=len(cases),
        version=require_mca().version,
    )


def loop_report(
    bench: Workbench, candidate: Emitted, target: Target, region: str = ""
) -> McaReport:
    """What llvm-mca says of one pass of the loop, over all lanes in flight. Raises KernelError.

    `region`: of another loop, as marked in the text.
    """
    region = region or ("lanes" if candidate.is_batch else "loop")
    sources = candidate.with_regions
    compiler, flags = candidate.compiler, candidate.flags

    def make() -> dict[str, object]:
        text = assembly_of(sources, (), compiler, flags, candidate.name)
        return asdict(analyse(text, target, region))

    texts = sorted(sources.items())
    key = key_of(texts, compiler.version, flags, require_mca().version, target.row.mca_cpu, region)
    kept = bench.store.kept("llvm-mca figures", key, make)
    return McaReport(**{**kept, "path_cycles": tuple(kept["path_cycles"])})


def frame_bound(bench: Workbench, candidate: Emitted, target: Target) -> float:
    """Cycles that reading, checking and writing a collision needs at least, in an exact batch.

    Raises KernelError.
    """
    return frame_cycles(
        candidate.variant,
        target,
        lambda region: loop_report(bench, candidate, target, region).throughput_bound,
    )


def frame_cycles(variant: Variant, target: Target, bound: Callable[[str], float]) -> float:
    """The same from what a trip of each marked loop needs; loops inside them count as one trip."""
    lanes = lane_context(target, variant.width, variant.vectors, precision=precision_of(variant))
    part = lanes.frame.width if lanes.frame else lanes.whole
    # A trip of the outer loop, "take", is counted with one of the inner one, "frame".
    rest = 1 / part - 1 / lanes.whole
    return bound("take") / lanes.whole + bound("frame") * rest + bound("leave") / part


def lanes_in_flight(variant: Variant) -> int:
    """Lanes of all vectors that a pass of the marked loop works on in turn."""
    return variant.width * (2 if variant.paired else variant.vectors)
