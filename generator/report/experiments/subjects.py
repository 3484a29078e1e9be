"""Which kernels a report is about, and by what role it calls them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ...choice.candidates import baseline, contest_for, published
from ...choice.lookup import kernel_for, with_compiler_found
from ...choice.selection import place_of, read_selection
from ...choice.trials import Final
from ...registry.names import name_of
from ...registry.question import Goal
from ...registry.rules import broken_rule
from ...registry.variant import Variant
from ...targets.target import Target
from ...toolchain.compilers import Compiler

STEPS = 1000
BUDGETS = (1e-3, 1e-6, 1e-9)
BASELINE, BEST, EULER = "paper-initial", "paper-best", "Euler, chosen"


@dataclass(frozen=True)
class Subject:
    """A kernel and its role. `featured`: everything is measured of it, else only its time."""

    role: str
    variant: Variant
    featured: bool

    @property
    def name(self) -> str:
        return name_of(self.variant)


@dataclass(frozen=True)
class Called:
    """A kernel by the function that it is called through. `role` is shared by those compared."""

    role: str
    variant: Variant
    batch: bool


def role_of_budget(budget: float) -> str:
    return f"E = {budget:.0e}, chosen"


def _chosen_by_sweep(finals: dict[str, Final], call: str) -> dict[tuple[int | None, str], Variant]:
    """By steps, or by budget as text; the finals of one way to call."""
    found = {}
    for final in finals.values():
        subject = next((f.subject for f in final.finalists if f.subject.name == final.chosen), None)
        try:
            if subject is None or subject.asked.contest.call != call:
                continue
            goal = subject.asked.goal
            budget = "" if goal.budget is None else f"{goal.budget:.0e}"
            found[goal.steps, budget] = subject.variant()
        except ValueError:
            continue  # of a registry that had other options
    return found


def subjects(
    generated: Path,
    target: Target,
    scene: str,
    model: str,
    compilers: dict[str, Compiler],
    finals: dict[str, Final],
) -> list[Subject]:
    """The baseline first; what a sweep chose, else what `generated/` holds, else the default."""
    codes = list(compilers)
    by_steps = contest_for(target, scene, model, Goal(steps=STEPS))
    rows = published(by_steps)
    rows[BASELINE] = baseline(by_steps, codes)
    found = [Subject(role, variant, role in (BASELINE, BEST)) for role, variant in rows.items()]
    chosen = _chosen_by_sweep(finals, "scalar")
    goals: list[tuple[str, Goal, tuple[int | None, str]]] = [
        (EULER, Goal(steps=STEPS), (STEPS, ""))
    ]
    goals += [(role_of_budget(b), Goal(budget=b), (None, f"{b:.0e}")) for b in _budgets(chosen)]
    for role, goal, key in goals:
        variant = chosen.get(key)
        if variant is None:
            variant = kernel_for(generated, "native", replace(by_steps, goal=goal))
        found.append(Subject(role, variant, True))
    fitted = [_fitted(subject, target, compilers) for subject in found]
    return [subject for subject in fitted if broken_rule(subject.variant, target) is None]


def _budgets(chosen: Iterable[tuple[int | None, str]]) -> Sequence[float]:
    swept = {float(budget) for _, budget in chosen if budget}
    return tuple(sorted(swept | set(BUDGETS), reverse=True))


def _fitted(subject: Subject, target: Target, compilers: dict[str, Compiler]) -> Subject:
    """With a compiler that is here, and without FMA where the target has none."""
    variant = with_compiler_found(subject.variant, dict(compilers))
    if not target.has("fma"):
        variant = variant.with_options(fma="nofma")
    return Subject(subject.role, variant, subject.featured)


def lanes_in(generated: Path, target: Target, scene: str, model: str) -> list[Variant]:
    """Kernels with lanes that a folder of `generated` holds for a target."""
    found = []
    for name in ("native", target.name):
        selection = read_selection(place_of(generated, name, scene))
        if selection is not None and selection.resolved == target.name:
            own = [e for e in selection.kernels if e.model == model and e.width > 1]
            found += [entry.variant for entry in own]
    return found


def calls(
    found: Sequence[Subject], finals: dict[str, Final], in_generated: Sequence[Variant] = ()
) -> list[Called]:
    """For each goal: the scalar call first, the same kernel's batch, the batch kernels chosen."""
    swept = list(_chosen_by_sweep(finals, "batch").values())
    batches = {name_of(variant): variant for variant in [*swept, *in_generated]}
    listed = []
    for subject in found:
        if not subject.featured or subject.role == BEST:
            continue
        listed.append(Called(subject.role, subject.variant, False))
        listed.append(Called(subject.role, subject.variant, True))
        if subject.role != BASELINE:
            goal = subject.variant.stepper.goal
            own = [v for v in batches.values() if v.stepper.goal == goal and v != subject.variant]
            listed += [Called(subject.role, variant, True) for variant in own]
    return listed
