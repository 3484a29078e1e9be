"""Times of a report: all kernels, kind by kind, with other numbers of steps, in batches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...choice.kernel import Rejected, Verified
from ...choice.verifying import Expected
from ...choice.workbench import Workbench
from ...errors import KernelError
from ...evidence.timing.plan import PlannedKernel, TimingPlan
from ...evidence.timing.ratios import TimingResult, TimingRun, timing_results
from ...evidence.verification.errors import Array
from ...evidence.verification.reference import load_reference
from ...registry.names import name_of
from ...registry.variant import fixed_steps
from ...targets.target import Target
from ..findings import CallPoint, GrowthPoint, Modelled
from .accuracy import Accuracy, Rows, accuracy_of
from .profile import Profile
from .subjects import BASELINE, EULER, Called, Subject

GROWTH = (10, 100, 1000, 10_000, 100_000)
SLOW = 10_000  # from here on, errors over the reference alone and times in a plan of their own
KIND_CASES = 256  # the most that a kind is timed on


@dataclass
class Study:
    """A subject on its way."""

    subject: Subject
    candidate: Verified | Rejected
    timed: TimingResult | None = None
    accuracy: Accuracy | None = None
    profile: Profile | None = None
    modelled: tuple[Modelled, ...] = ()

    @property
    def rejected(self) -> str:
        """Why it was; empty where it passed."""
        return self.candidate.text if isinstance(self.candidate, Rejected) else ""

    @property
    def passed(self) -> bool:
        return not self.rejected

    @property
    def kernel(self) -> Verified:
        """Raises KernelError where it was rejected."""
        if isinstance(self.candidate, Rejected):
            raise KernelError(f"{self.candidate.name}: {self.candidate.text}")
        return self.candidate


def time_all(
    bench: Workbench, studies: Sequence[Study], cases: Array, scene: str, seconds: float
) -> TimingRun:
    """All subjects interleaved with the baseline, on mixed cases and on the report's five."""
    unique = {s.kernel.name: s.kernel for s in studies if s.passed}
    kernels = tuple(PlannedKernel(name, k.library.path, latency=True) for name, k in unique.items())
    evidence = bench.cases.evidence
    reference = load_reference(evidence.reference)
    seeds = reference.cases[reference.rows_of(evidence.seeds)]
    unrestricted = bench.tool.impact.find_scene(scene).unrestricted
    first = studies[0].candidate.name
    bench.progress(f"timing {len(kernels)} kernels for {seconds:.0f} s", 0, 1)
    plan = TimingPlan(
        cases, kernels, first, seeds if unrestricted else None, rounds=1000, seconds=seconds
    )
    run = bench.tool.time(plan)
    results = {result.name: result for result in timing_results(run)}
    for study in studies:
        study.timed = results.get(study.candidate.name)
    return run


def time_kinds(
    bench: Workbench,
    featured: Sequence[Study],
    kinds: Mapping[str, Rows],
    cases: Array,
    seconds: float,
) -> dict[str, dict[str, float]]:
    """ns by kind and kernel name, all kernels interleaved on the cases of one kind."""
    unique = {s.kernel.name: s.kernel for s in featured}
    kernels = tuple(PlannedKernel(name, k.library.path) for name, k in unique.items())
    found = {}
    for index, (kind, rows) in enumerate(kinds.items()):
        bench.progress("timing kind by kind", index, len(kinds))
        # A list shorter than a window is timed over and over.
        own = cases[np.resize(rows, max(16, min(len(rows), KIND_CASES)))]
        share = max(0.3, seconds / len(kinds))
        plan = TimingPlan(own, kernels, kernels[0].name, rounds=200, seconds=share)
        found[kind] = {r.name: r.ns for r in timing_results(bench.tool.time(plan))}
    return found


def growth_of(
    bench: Workbench,
    studies: Sequence[Study],
    target: Target,
    cases: Array,
    expected: Expected,
    seconds: float,
) -> list[GrowthPoint]:
    """The baseline and the chosen Euler kernel, made for other numbers of steps.

    Times are ratios to the baseline in the same rounds, times what the baseline takes among all.
    """
    rows = [
        (s.subject.role, steps, s.subject.variant.with_stepper(fixed_steps(steps)))
        for s in studies
        if s.subject.role in (BASELINE, EULER) and s.passed
        for steps in GROWTH
    ]
    made = bench.build_all(bench.emit_all([variant for _, _, variant in rows], target))
    named = [
        (role, steps, PlannedKernel(k.name, k.library.path))
        for (role, steps, _), k in zip(rows, made, strict=True)
        if not isinstance(k, Rejected)
    ]
    first = studies[0]
    if first.timed is None:
        return []
    base = PlannedKernel(first.kernel.name, first.kernel.library.path)
    ratios: dict[str, float] = {}
    for slow in (False, True):
        own = {base.name: base}
        own |= {kernel.name: kernel for _, steps, kernel in named if (steps >= SLOW) == slow}
        kernels = tuple(own.values())
        bench.progress("timing growth with N", int(slow), 2)
        plan = TimingPlan(cases, kernels, base.name, rounds=200, seconds=seconds / 2)
        ratios |= {r.name: r.ratio for r in timing_results(bench.tool.time(plan))}
    few = _some_rows(expected, slice(0, expected.reference_rows or 500))
    found = []
    for role, steps, kernel in named:
        accuracy = accuracy_of(bench.tool, kernel.library, few if steps >= SLOW else expected)
        ns = ratios[kernel.name] * first.timed.ns
        errors = {"error": accuracy.largest, "slipping_error": accuracy.slipping}
        found.append(GrowthPoint(role=role, steps=steps, ns=ns, **errors))
    return found


def _some_rows(expected: Expected, rows: slice) -> Expected:
    """Some of the cases alone."""
    return replace(
        expected,
        cases=expected.cases[rows],
        exact=expected.exact[rows],
        euler=None if expected.euler is None else expected.euler[rows],
        labels=expected.labels[rows],
    )


def time_calls(
    bench: Workbench,
    called: Sequence[Called],
    target: Target,
    expected: Expected,
    seconds: float,
) -> list[CallPoint]:
    """Each goal's kernels through either function, on the cases that all batches are timed on."""
    emitted = bench.emit_all([c.variant for c in called], target)
    kernels = bench.verify_all(bench.build_all(emitted))
    rows = [
        (one, f"{index}", kernel)
        for index, (one, kernel) in enumerate(zip(called, kernels, strict=True))
        if not isinstance(kernel, Rejected)
    ]
    if not rows:
        return []
    bench.progress("timing batches", 0, 1)
    planned = tuple(
        PlannedKernel(label, kernel.library.path, batch=one.batch) for one, label, kernel in rows
    )
    cases = bench.cases.timed(expected.scene, called[0].variant.model, batches=True)
    run = bench.tool.time(TimingPlan(cases, planned, planned[0].name, rounds=400, seconds=seconds))
    scalar = {one.role: label for one, label, _ in reversed(rows) if not one.batch}
    return [
        _call(run, one, label, scalar[one.role]) for one, label, _ in rows if one.role in scalar
    ]


def _call(run: TimingRun, one: Called, label: str, scalar: str) -> CallPoint:
    """Against the scalar call of the same goal instead of the first."""
    results = timing_results(replace(run, baseline=scalar))
    return CallPoint(
        role=one.role,
        kernel=name_of(one.variant),
        width=one.variant.width,
        call="batch" if one.batch else "scalar",
        timed=next(result for result in results if result.name == label),
    )
