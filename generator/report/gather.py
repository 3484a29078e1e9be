"""From stored records and measurements to the data of the page. Nothing is measured here."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import __version__
from ..evidence.verification.reference import CASE_NAMES, OUTCOME_NAMES
from ..sweep.record import Final, Run, Trial
from . import contests as from_trials
from .chosen import chosen_of, points_of
from .data import (
    Contest,
    CpuCost,
    GrowthFit,
    KindCell,
    KindRow,
    Machine,
    MissRow,
    ModelRow,
    Operations,
    OutputErrors,
    Report,
    Sections,
    Worst,
)
from .measured import CallPoint, KernelFigures, Measured, sources_hash
from .published import NOT_KNOWN, published_rows

NOT_MEASURED = "not measured yet: ./gen report --measure"
NO_RECORDS = "no CPU has records of it in timings/: ./gen results refresh"
NO_SWEEP = "no sweep is stored for it: ./gen sweep"


@dataclass(frozen=True)
class Stored:
    """What a store holds of one target, scene and model; `finals` by contest, the newest."""

    runs: tuple[Run, ...]
    trials: tuple[Trial, ...]
    finals: dict[str, Final]


def gather(
    target: str,
    scene: str,
    model: str,
    cpu: str,
    stored: Stored,
    measured: Measured | None,
    commands: Sequence[str],
    costs: Sequence[CpuCost] = (),
) -> Report:
    """All that is known; `missing` names what is not and the command that would make it known."""
    contests = from_trials.contests_of(stored.trials, stored.finals)
    calls = measured.calls if measured else ()
    missing = _missing(stored, measured, contests, calls)
    chosen = chosen_of(stored.finals, measured)
    return Report(
        title=f"Collision kernels for {target}",
        scene=scene,
        model=model,
        machine=_machine(target, cpu, stored, measured),
        sweep=from_trials.summary_of(stored.runs, stored.trials) if stored.trials else None,
        chosen=tuple(chosen),
        contests=tuple(contests),
        points=tuple(points_of(measured)),
        outputs=tuple(OutputErrors(k.role, k.outputs) for k in _kernels(measured) if k.outputs),
        worst=tuple(_worst(k, model) for k in _kernels(measured) if k.worst),
        kinds=tuple(_kinds(measured)),
        effects=tuple(from_trials.effects_of(contests)),
        compilers=tuple(from_trials.effects_of(contests, only="compiler")),
        growth=measured.growth if measured else (),
        growth_fits=tuple(_fits(measured)),
        operations=tuple(_operations(k) for k in _kernels(measured) if k.counts),
        sections=tuple(_sections(k) for k in _kernels(measured) if k.sections and k.timed),
        modelled=tuple(_modelled(measured)),
        misses=tuple(
            MissRow(k.role, m.source, m.by, m.built_for, m.events)
            for k in _kernels(measured)
            for m in k.misses
        ),
        calls=calls,
        published=tuple(published_rows(measured, calls)),
        commands=tuple(commands),
        missing=missing if costs else {**missing, "cpus": NO_RECORDS},
        cpus=tuple(costs),
    )


def _kernels(measured: Measured | None) -> tuple[KernelFigures, ...]:
    return measured.kernels if measured else ()


def _machine(target: str, cpu: str, stored: Stored, measured: Measured | None) -> Machine:
    runs = stored.runs
    compilers = dict(measured.compilers if measured else runs[-1].compilers if runs else {})
    seeds = dict(measured.seeds) if measured else {}
    if runs:
        seeds["sweep"] = runs[-1].seed
    return Machine(
        cpu=measured.cpu if measured else cpu,
        target=target,
        system=runs[-1].system if runs else f"{platform.system()} {platform.release()}",
        compilers=compilers,
        flags=dict(measured.flags) if measured else {},
        seeds=seeds,
        tsc_ghz=measured.tsc_ghz if measured else None,
        control=measured.control if measured else None,
        version=__version__,
        measured_at=measured.made_at if measured else None,
    )


def _missing(
    stored: Stored,
    measured: Measured | None,
    contests: Sequence[Contest],
    calls: Sequence[CallPoint],
) -> dict[str, str]:
    """Reasons by the name of the page's section."""
    found: dict[str, str] = {"published": NOT_KNOWN}
    if not stored.trials:
        found |= dict.fromkeys(("contests", "effects", "compilers"), NO_SWEEP)
    elif not contests:
        found["contests"] = "no variant of the stored sweep was timed"
    if measured is None:
        names = ("outputs", "worst", "kinds", "growth", "operations", "sections")
        found |= dict.fromkeys((*names, "modelled", "misses", "calls"), NOT_MEASURED)
        return found
    if not any(row.width > 1 for row in calls):
        found["lanes"] = (
            "no kernel with lanes was chosen by a stored sweep or lies in generated/; ./gen sweep "
            "--call batch looks for one"
        )
    found |= _unmeasured(measured)
    swept = {final.chosen for final in stored.finals.values()}
    known = {kernel.name for kernel in measured.kernels} | {row.kernel for row in calls}
    if stale := sorted(swept - known):
        found["measured"] = (
            f"{len(stale)} of the kernels that the sweep chose were not measured, as {stale[0]}: "
            "./gen report --measure"
        )
    if measured.sources != sources_hash():
        found["age"] = (
            f"what was measured ({measured.made_at}) is of kernels as other sources of carom gave "
            "them: ./gen report --measure makes it anew"
        )
    return found


def _unmeasured(measured: Measured) -> dict[str, str]:
    """What a tool could not do, once for all kernels that it failed for the same reason."""
    roles: dict[tuple[str, str], list[str]] = {}
    for kernel in measured.kernels:
        for what, reason in kernel.missing.items():
            roles.setdefault((what, reason), []).append(kernel.role)
    everyone = sum(bool(kernel.kinds) for kernel in measured.kernels)
    found = {}
    for (what, reason), own in roles.items():
        of = "all kernels" if len(own) == everyone else "; ".join(own)
        found[f"{what} of {of}"] = reason
    return found


def _worst(kernel: KernelFigures, model: str) -> Worst:
    assert kernel.worst is not None
    goal = f"--steps {kernel.steps}" if kernel.steps else f"--max-error {kernel.budget:g}"
    header = ",".join(("id", *CASE_NAMES))
    row = ",".join(("worst", *kernel.worst.inputs))
    return Worst(
        role=kernel.role,
        kernel=kernel.name,
        label=kernel.worst.label,
        error=kernel.worst.error,
        names=CASE_NAMES,
        inputs=kernel.worst.inputs,
        outputs=OUTCOME_NAMES,
        got=kernel.worst.got,
        exact=kernel.worst.exact,
        commands=(
            f"printf '%s\\n' {header} {row} > worst.csv",
            f"./gen collide --cases worst.csv --out outcome.csv --model {model} {goal}",
        ),
    )


def _kinds(measured: Measured | None) -> list[KindRow]:
    kernels = [k for k in _kernels(measured) if k.kinds]
    names = dict.fromkeys(kind for kernel in kernels for kind in kernel.kinds)
    return [
        KindRow(
            kind=kind,
            cases=max(k.kinds[kind].cases for k in kernels if kind in k.kinds),
            cells={
                k.role: KindCell(k.kinds[kind].error, k.kinds[kind].ns, k.kinds[kind].evaluations)
                for k in kernels
                if kind in k.kinds
            },
        )
        for kind in sorted(names)
    ]


def _fits(measured: Measured | None) -> list[GrowthFit]:
    """What each step takes and what none of them does: least squares of relative deviations."""
    found = []
    for role in dict.fromkeys(point.role for point in (measured.growth if measured else ())):
        assert measured is not None
        own = [point for point in measured.growth if point.role == role]
        if len(own) > 1:
            steps, ns = np.array([[p.steps, p.ns] for p in own], dtype=float).T
            per_step, fixed = np.polyfit(steps, ns, 1, w=1 / ns)
            found.append(GrowthFit(role, float(fixed), float(per_step)))
    return found


def _operations(kernel: KernelFigures) -> Operations:
    counts, cycles = kernel.counts, kernel.timed.cycles if kernel.timed else None
    assert counts is not None
    return Operations(
        role=kernel.role,
        per_step=counts.per_step,
        stated=counts.stated,
        per_collision=counts.per_collision,
        evaluations=counts.evaluations,
        flops=counts.flops,
        cycles=cycles,
        flops_per_cycle=counts.flops / cycles if cycles else None,
        refused=counts.refused,
    )


def _sections(kernel: KernelFigures) -> Sections:
    assert kernel.sections is not None
    assert kernel.timed is not None
    shares, ns = kernel.sections.shares, kernel.timed.ns
    return Sections(
        kernel.role,
        shares,
        {name: share * ns for name, share in shares.items()},
        kernel.sections.unknown,
        kernel.sections.samples,
    )


def _modelled(measured: Measured | None) -> list[ModelRow]:
    return [
        ModelRow(
            role=k.role,
            target=m.target,
            cpu=m.cpu,
            cycles=m.cycles,
            bound=m.bound,
            uops=m.uops,
            ipc=m.ipc,
            bottleneck=m.bottleneck,
            pressure=dict(m.pressure),
            collision=m.collision,
            note=m.note,
        )
        for k in _kernels(measured)
        for m in k.modelled
    ]
