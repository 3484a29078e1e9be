"""What the picture of speed against error shows: fixed steps beside the exact steppers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from ...choice.candidates import baseline, contest_for, exact_candidates
from ...choice.cases import TIMING_CASES, TIMING_SEED
from ...choice.kernel import Built, Rejected
from ...choice.lookup import kernel_for, with_compiler_found
from ...choice.workbench import Workbench
from ...errors import KernelError
from ...evidence.timing.plan import PlannedKernel, TimingPlan
from ...evidence.timing.ratios import Speed, TimingResult, timing_results
from ...evidence.verification.errors import SLIPS, Array
from ...registry.names import name_of
from ...registry.question import Goal
from ...registry.rules import broken_rule
from ...registry.variant import Stepper, Variant, fixed_steps, make_variant
from ...steppers.budgets import tableaus_for
from ...tableaus.tableaus import TABLEAUS
from ...targets.host import read_host
from ...targets.target import Target

BASELINE_STEPS = 1000
STEPS = (10, 30, 100, 300, 1000, 3000, 10**4, 3 * 10**4, 10**5, 3 * 10**5, 10**6)
SLOW_STEPS = 10**4  # from here on, errors on fewer cases and times in a plan of their own
BUDGETS = tuple(float(f"1e-{digits}") for digits in range(2, 13))
FAMILY_BUDGETS = (1e-2, 1e-4, 1e-6, 1e-9, 1e-12)
SEED, RANDOM = 20142, 5000
SLOW_RANDOM = 60  # those that are worst with the most steps before

Group = Literal["baseline", "euler", "exact", "family"]


class Point(Speed):
    """A kernel in the picture. Times are of the mixed set."""

    group: Group
    kernel: str
    stepper: str
    steps: int | None
    budget: float | None
    max_rel_error: float  # against the exact result, relative to |v1 - v2|
    max_slipping_error: float  # the same over the cases whose contact slips to the end
    cases: int  # that the error was taken over
    within_budget: bool  # or no budget to be within


class SpeedError(BaseModel):
    """The data of the picture."""

    model_config = ConfigDict(frozen=True)

    cpu: str
    target: str
    scene: str
    model: str
    compilers: dict[str, str]
    points: tuple[Point, ...]

    def document(self) -> dict[str, Any]:
        return {"schema": 1, **self.model_dump(mode="json")}


def speed_error_of(document: dict[str, Any]) -> SpeedError:
    """The data as `document` gave it. Raises ValueError where something is missing."""
    return SpeedError.model_validate(document)


@dataclass
class Entry:
    """A kernel on its way into the picture."""

    group: Group
    candidate: Built
    error: float = float("nan")
    slipping_error: float = float("nan")
    cases: int = 0

    @property
    def budget(self) -> float | None:
        return self.candidate.variant.stepper.budget

    @property
    def steps(self) -> int:
        return self.candidate.variant.stepper.steps or 0

    @property
    def slow(self) -> bool:
        return self.steps >= SLOW_STEPS

    @property
    def within_budget(self) -> bool:
        return self.error <= (self.budget or np.inf)


def measure_speed_error(
    bench: Workbench,
    generated: Path,
    target: Target,
    scene: str,
    model: str,
    seconds: float,
) -> SpeedError:
    """Emit, compile, verify and time all that the picture shows."""
    entries = _entries(bench, generated, target, scene, model)
    _find_errors(bench, entries, scene, model)
    entries = [entry for entry in entries if entry.error < 1]
    times = _times(bench, entries, seconds)
    found = [_point(entry, times[entry.candidate.name]) for entry in entries]
    versions = {code: compiler.version for code, compiler in bench.compilers.items()}
    points = _ordered(_with_the_chosen(found))
    return SpeedError(
        cpu=read_host().cpu,
        target=target.name,
        scene=scene,
        model=model,
        compilers=versions,
        points=points,
    )


def _entries(
    bench: Workbench, generated: Path, target: Target, scene: str, model: str
) -> list[Entry]:
    """The baseline first; a kernel that belongs to two groups is measured once, in the first."""
    codes = list(bench.compilers)
    by_steps = contest_for(target, scene, model, Goal(steps=BASELINE_STEPS))
    budgets = [contest_for(target, scene, model, Goal(budget=budget)) for budget in BUDGETS]
    first, best = baseline(by_steps, codes), kernel_for(generated, "native", by_steps)
    best = with_compiler_found(best, dict(bench.compilers))
    groups: dict[Group, Iterable[Variant]] = {
        "baseline": [first],
        "euler": [best.with_stepper(fixed_steps(n)) for n in STEPS],
        "exact": [v for contest in budgets for v in exact_candidates(contest, codes[:1])],
        "family": _family(target, scene, model, codes[0]),
    }
    labelled = [(group, variant) for group, variants in groups.items() for variant in variants]
    unique = {name_of(variant): (group, variant) for group, variant in reversed(labelled)}
    rows = list(reversed(unique.values()))
    made = bench.build_all(bench.emit_all([variant for _, variant in rows], target))
    pairs = zip(rows, made, strict=True)
    return [Entry(group, k) for (group, _), k in pairs if not isinstance(k, Rejected)]


def _family(target: Target, scene: str, model: str, compiler: str) -> list[Variant]:
    """Every tableau at a few budgets, with the cheapest root that a budget allows."""
    fma = "fma" if target.has("fma") else "nofma"
    found = []
    for budget in FAMILY_BUDGETS:
        for name in TABLEAUS:
            stepper = Stepper(name, budget=budget)
            options = {"compiler": compiler, "fma": fma}
            for root in ("est1", "inv") if budget >= 1e-6 else ("inv",):
                variant = make_variant(target.name, scene, model, stepper, root=root, **options)
                if broken_rule(variant, target) is None:
                    found.append(variant)
                    break
    return found


def _find_errors(bench: Workbench, entries: Sequence[Entry], scene: str, model: str) -> None:
    """Largest relative errors against the exact result; infinite where a status is wrong.

    Kernels of very many steps run the reference and only those random cases that were worst.
    """
    expected = bench.cases.expected(scene, model, None, SEED, RANDOM)
    cases, exact = expected.cases, expected.exact
    measure, columns = bench.cases.evidence.measure, bench.tool.columns
    slipping = exact[:, columns.sticks] == SLIPS
    rows, relative = np.arange(len(cases)), np.zeros(len(cases))
    for index, entry in enumerate(sorted(entries, key=lambda e: e.steps)):
        bench.progress("finding errors", index, len(entries))
        if entry.slow and len(rows) == len(cases):
            rows = _hard_rows(relative, slipping, expected.reference_rows)
        got = bench.tool.run_kernel(entry.candidate.library.path, cases[rows], timeout=600.0)
        relative = measure.errors_of(cases[rows], got, exact[rows]).relative
        relative = np.where(got[:, columns.status] == exact[rows, columns.status], relative, np.inf)
        entry.error, entry.cases = float(relative.max()), len(rows)
        entry.slipping_error = float(relative[slipping[rows]].max())


def _hard_rows(relative: Array, slipping: NDArray[np.bool_], reference_rows: int) -> Any:
    """The reference, and the random cases with the largest errors, slipping ones and others."""
    rows = np.arange(len(relative))
    picked = [rows[:reference_rows]]
    for among in (slipping, ~slipping):
        left = rows[(rows >= reference_rows) & among]
        picked.append(left[np.argsort(-relative[left])][: SLOW_RANDOM // 2])
    return np.sort(np.concatenate(picked))


def _times(bench: Workbench, entries: Sequence[Entry], seconds: float) -> dict[str, TimingResult]:
    """All kernels interleaved with the baseline; those of very many steps in a plan of their own,
    for a block of them takes a hundred times as long as one of the others.
    """
    cases = bench.tool.make_cases(TIMING_SEED, TIMING_CASES).rows
    first = entries[0]
    found: dict[str, TimingResult] = {}
    for slow, share in ((False, 0.7), (True, 0.3)):
        own = [e for e in entries if e.slow == slow or e is first]
        planned = tuple(PlannedKernel(e.candidate.name, e.candidate.library.path) for e in own)
        bench.progress(f"timing {len(planned)} kernels for {share * seconds:.0f} s", 0, 1)
        plan = TimingPlan(
            cases, planned, first.candidate.name, rounds=1000, seconds=share * seconds
        )
        for result in timing_results(bench.tool.time(plan)):
            found.setdefault(result.name, result)
    return found


def _point(entry: Entry, timing: TimingResult) -> Point:
    stepper = entry.candidate.variant.stepper
    return Point(
        group=entry.group,
        kernel=entry.candidate.name,
        stepper="euler" if stepper.steps else stepper.name,
        steps=stepper.steps,
        budget=stepper.budget,
        max_rel_error=float(f"{entry.error:.3g}"),
        max_slipping_error=float(f"{entry.slipping_error:.3g}"),
        cases=entry.cases,
        within_budget=entry.within_budget,
        **timing.rounded(4),
    )


def _with_the_chosen(points: Sequence[Point]) -> list[Point]:
    """For each budget the fastest candidate that keeps it, as ./gen chooses; others: the family."""
    chosen = []
    for budget in BUDGETS:
        names = tableaus_for(budget)
        fit = [p for p in points if p.budget == budget and p.stepper in names and p.within_budget]
        if not fit:
            raise KernelError(f"no exact kernel keeps the budget {budget:g}")
        chosen.append(min(fit, key=lambda p: p.ratio).kernel)
    found = []
    for point in points:
        own = point.group if point.budget is None else "family"
        found.append(point.model_copy(update={"group": "exact" if point.kernel in chosen else own}))
    return found


def _ordered(points: Iterable[Point]) -> tuple[Point, ...]:
    groups = ("baseline", "euler", "exact", "family")
    return tuple(
        sorted(
            points, key=lambda p: (groups.index(p.group), p.steps or 0, -(p.budget or 0), p.kernel)
        )
    )


def pareto_front(points: Iterable[Point]) -> list[Point]:
    """Those that no other beats in both time and error, from the fastest to the most exact."""
    front: list[Point] = []
    for point in sorted(points, key=lambda p: (p.ratio, p.max_rel_error)):
        if not front or point.max_rel_error < front[-1].max_rel_error:
            front.append(point)
    return front
