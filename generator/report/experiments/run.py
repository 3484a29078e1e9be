"""`./gen report --measure`: what a report needs that no sweep keeps. Minutes, once, then read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from ...choice.cases import TIMING_CASES, TIMING_SEED, VERIFY_SEED
from ...choice.kernel import verdict_of
from ...choice.verifying import Expected
from ...choice.workbench import Workbench
from ...errors import KernelError
from ...evidence.timing.ratios import control_band
from ...evidence.verification.errors import Array
from ...targets.host import Host
from ...targets.target import Target, targets
from ..findings import Findings, KernelFindings, KindFindings, sources_hash
from .accuracy import Rows, accuracy_of, kinds_of
from .modelled import modelled
from .profile import profile
from .progress import Schedule
from .subjects import BASELINE, STEPS, Called, Subject
from .times import GROWTH, Study, growth_of, time_all, time_calls, time_kinds

SAMPLE_SECONDS = 1.5
PROFILED_CASES = 512  # of the timed ones
# First guesses of seconds that a kernel takes: to be built and verified, to be profiled, to be
# replayed on a target. A schedule starts from them and follows what the stages did take.
_BUILT, _PROFILED, _REPLAYED = 6.0, 20.0, 4.0


@dataclass(frozen=True)
class Order:
    """What is measured where. `seconds` is for each of four timings."""

    target: Target
    host: Host
    scene: str
    model: str
    seconds: float
    command: str


def run_experiments(
    bench: Workbench, found: Sequence[Subject], called: Sequence[Called], order: Order
) -> Findings:
    """Build, verify, time and profile the subjects.

    Raises KernelError where the baseline itself does not pass.
    """
    schedule = Schedule(_planned(found, called, order.seconds), bench.progress)
    bench.progress = schedule
    try:
        return _measured(bench, found, called, order, schedule)
    finally:
        bench.progress = schedule.show


def _planned(
    found: Sequence[Subject], called: Sequence[Called], seconds: float
) -> tuple[float, ...]:
    """Seconds of each stage, in the order of `_measured`."""
    featured = sum(subject.featured for subject in found)
    return (
        _BUILT * len(found),
        seconds,
        _PROFILED * featured,
        seconds,
        _REPLAYED * featured * len(targets()),
        seconds + 2 * _BUILT * len(GROWTH),
        seconds + _BUILT * len(called),
    )


def _measured(
    bench: Workbench,
    found: Sequence[Subject],
    called: Sequence[Called],
    order: Order,
    schedule: Schedule,
) -> Findings:
    scene, target, seconds = order.scene, order.target, order.seconds
    schedule.next()
    studies, expected = _verified(bench, found, order)
    timing = bench.cases.timed(scene, order.model)
    schedule.next()
    run = time_all(bench, studies, timing, scene, seconds)
    schedule.next()
    featured = [s for s in studies if s.subject.featured and s.passed]
    profiled = timing[:PROFILED_CASES]
    for study in _told(bench, "errors, counts, sections and misses", featured):
        _look_into(bench, study, expected, order.host, profiled)
    schedule.next()
    kinds = kinds_of(expected.labels[: len(expected.cases)])  # not of the hard ones, which follow
    times = time_kinds(bench, featured, kinds, expected.cases, seconds)
    schedule.next()
    for study in _told(bench, "llvm-mca on every target", featured):
        study.modelled = modelled(bench, study.subject.variant, order.host, timing)
    schedule.next()
    growth = growth_of(bench, studies, target, timing, expected, seconds)
    schedule.next()
    calls = time_calls(bench, called, target, expected, seconds)
    return Findings(
        made_at=datetime.now(UTC).isoformat(timespec="seconds"),
        sources=sources_hash(),
        command=order.command,
        cpu=order.host.cpu,
        target=target.name,
        scene=scene,
        model=order.model,
        compilers={code: c.version for code, c in bench.compilers.items()},
        flags={s.subject.role: " ".join(s.candidate.emitted.flags) for s in studies},
        seeds={"verification": VERIFY_SEED, "timing": TIMING_SEED},
        tsc_ghz=run.tsc_ghz,
        control=control_band(run),
        rounds=run.rounds,
        timing_cases=TIMING_CASES,
        verified_cases=len(expected.cases),
        kernels=tuple(
            _findings(study, _kinds(study, kinds, times), run.tsc_ghz) for study in studies
        ),
        growth=tuple(growth),
        calls=tuple(calls),
    )


def _told(bench: Workbench, what: str, studies: Sequence[Study]) -> Iterator[Study]:
    """One after the other, each told as it begins."""
    for index, study in enumerate(studies):
        bench.progress(what, index, len(studies))
        yield study


def _look_into(
    bench: Workbench, study: Study, expected: Expected, host: Host, timed: Array
) -> None:
    """A kernel's errors, and what the tools of profiling find of it."""
    kernel = study.kernel
    study.accuracy = accuracy_of(bench.tool, kernel.library.path, expected)
    study.profile = profile(bench, kernel, host, expected.cases, timed, SAMPLE_SECONDS)


def _verified(
    bench: Workbench, found: Sequence[Subject], order: Order
) -> tuple[list[Study], Expected]:
    emitted = bench.emit_all([s.variant for s in found], order.target)
    kernels = bench.verify_all(bench.build_all(emitted))
    studies = [Study(s, k) for s, k in zip(found, kernels, strict=True)]
    if not studies or studies[0].subject.role != BASELINE or not studies[0].passed:
        reason = studies[0].rejected if studies else "no subject"
        raise KernelError(f"{BASELINE}: {reason}")
    return studies, bench.cases.expected(order.scene, order.model, STEPS)


def _findings(study: Study, kinds: dict[str, KindFindings], tsc_ghz: float) -> KernelFindings:
    candidate, found, accuracy = study.candidate, study.profile, study.accuracy
    missing, verdict = dict(found.missing) if found else {}, verdict_of(candidate)
    if study.rejected:
        missing["kernel"] = study.rejected
    stepper = study.subject.variant.stepper
    seed_ns = study.timed.seed_ns if study.timed else None
    return KernelFindings(
        role=study.subject.role,
        name=candidate.name,
        steps=stepper.steps,
        budget=stepper.budget,
        timed=study.timed,
        seed_cycles=None if seed_ns is None else seed_ns * tsc_ghz,
        verified_error=verdict.max_rel_error if verdict else None,
        error=accuracy.largest if accuracy else None,
        outputs=accuracy.outputs if accuracy else {},
        worst=accuracy.worst if accuracy else None,
        kinds=kinds,
        counts=found.counts if found else None,
        sections=found.sections if found else None,
        misses=found.misses if found else (),
        modelled=study.modelled,
        missing=missing,
    )


def _kinds(
    study: Study, kinds: dict[str, Rows], times: dict[str, dict[str, float]]
) -> dict[str, KindFindings]:
    if study.accuracy is None or study.profile is None or not study.profile.each:
        return {}
    each = np.array(study.profile.each, dtype=float)
    return {
        kind: KindFindings(
            cases=len(rows),
            error=float(study.accuracy.by_case[rows].max()),
            ns=times.get(kind, {}).get(study.candidate.name),
            evaluations=float(each[rows].mean()),
        )
        for kind, rows in kinds.items()
    }
