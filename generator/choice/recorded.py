"""A choice for a CPU that is not here: by its records, and by llvm-mca for what has none."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..evidence.records.code import compiled_hash, source_hash
from ..evidence.records.record import Basis
from ..registry.names import name_of
from ..registry.question import Contest
from ..registry.rules import broken_rule
from ..registry.variant import Variant
from ..targets.target import Target
from .choose import Choice, choose_by_model, choose_by_records, eligible
from .store import key_of
from .workbench import Candidate, Workbench

MORE = 6  # of the fastest recorded recipes that are candidates, too

Model = Callable[[Sequence[Candidate]], None]


def with_recorded(
    bench: Workbench, known: Sequence[Variant], target: Target, contest: Contest
) -> list[Variant]:
    """Candidates, and kernels of the recipes that were fastest on that CPU, each once."""
    fastest = bench.timings.fastest(contest, target.name, MORE)
    return legal_here(bench, [*known, *fastest], target)


def legal_here(bench: Workbench, variants: Sequence[Variant], target: Target) -> list[Variant]:
    """Each once, by the compilers that are here, without those that break a rule."""
    there = [v for v in variants if v["compiler"] in bench.compilers]
    return list({name_of(v): v for v in there if broken_rule(v, target) is None}.values())


def note_records(
    bench: Workbench,
    candidates: Sequence[Candidate],
    baseline: Candidate,
    target: Target,
) -> None:
    """Give each candidate the record that tells most of it, if that CPU ever timed it."""
    if not bench.timings.contests(target.name):
        return
    variant = candidates[-1].variant
    batch = variant.width > 1
    cases = (bench.batch_cases if batch else bench.timing_cases)(variant.scene, variant.model)
    first = compiled_hash(baseline.source, baseline.compiler.version, baseline.flags)
    for c in candidates:
        now = Basis(
            source=source_hash(c.source),
            compiler=c.compiler.version,
            flags=" ".join(c.flags),
            cases=key_of(cases, cases.shape[1]),
            bench=bench.tool.executable.name,
            baseline=first,
        )
        c.recorded = bench.timings.find(target.name, c.variant, now)


def choose_elsewhere(
    bench: Workbench,
    candidates: Sequence[Candidate],
    baseline: Candidate,
    target: Target,
    model: Model,
) -> Choice:
    """By the records of the target; `model` gives llvm-mca's cycles to those without any.

    The baseline and the kernel that the records choose are modelled beside these, to compare.
    """
    note_records(bench, candidates, baseline, target)
    fit = eligible(candidates)
    without = [c for c in fit if c.recorded is None]
    if len(without) == len(fit):
        model([baseline, *(c for c in candidates if c is not baseline)])
        return choose_by_model(candidates, target.row.mca_cpu, lambda v: bench.timings.wins(v))
    if without:
        winner = choose_by_records(fit, target).chosen
        model([baseline, winner, *without])
        winner.rejected = ""  # a kernel that was timed needs no model
    return choose_by_records(fit, target)
