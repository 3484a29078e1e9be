"""`./gen report --measure`: what a report needs that no sweep keeps. Minutes, once, then read."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np

from ..choice.verifying import Expected
from ..choice.workbench import (
    TIMING_CASES,
    TIMING_SEED,
    VERIFY_RANDOM,
    VERIFY_SEED,
    Workbench,
)
from ..errors import KernelError
from ..evidence.timing.ratios import control_band
from ..evidence.verification.errors import Array
from ..evidence.verification.scene_cases import cases_for_scene
from ..impacts.ball_ball.scene import find_scene
from ..targets.host import Host
from ..targets.target import Target
from .accuracy import accuracy_of, kinds_of
from .measured import KernelFigures, KindFigures, Measured, sources_hash
from .modelled import modelled
from .profile import profile
from .subjects import BASELINE, STEPS, Called, Subject
from .times import Study, growth_of, time_all, time_calls, time_kinds

SAMPLE_SECONDS = 1.5
PROFILED_CASES = 512  # of the timed ones


def measure(
    bench: Workbench,
    found: Sequence[Subject],
    called: Sequence[Called],
    target: Target,
    host: Host,
    scene: str,
    model: str,
    seconds: float,
    command: str,
) -> Measured:
    """Build, verify, time and profile the subjects. `seconds` is for each of four timings.

    Raises KernelError where the baseline itself does not pass.
    """
    studies, expected = _verified(bench, found, target, scene, model)
    timing = cases_for_scene(
        find_scene(scene), bench.tool.make_cases(TIMING_SEED, TIMING_CASES).rows, model
    )
    run = time_all(bench, studies, timing, scene, seconds)
    featured = [s for s in studies if s.subject.featured and not s.candidate.rejected]
    for index, study in enumerate(featured):
        bench.progress("errors, counts, sections and misses", index, len(featured))
        assert study.candidate.library is not None
        study.accuracy = accuracy_of(bench.tool, study.candidate.library.path, expected)
        timed = timing[:PROFILED_CASES]
        study.profile = profile(bench, study.candidate, host, expected.cases, timed, SAMPLE_SECONDS)
    kinds = time_kinds(bench, featured, expected, seconds)
    return Measured(
        made_at=datetime.now(UTC).isoformat(timespec="seconds"),
        sources=sources_hash(),
        command=command,
        cpu=host.cpu,
        target=target.name,
        scene=scene,
        model=model,
        compilers={code: c.version for code, c in bench.compilers.items()},
        flags={s.subject.role: " ".join(s.candidate.flags) for s in studies},
        seeds={"verification": VERIFY_SEED, "timing": TIMING_SEED},
        tsc_ghz=run.tsc_ghz,
        control=control_band(run),
        rounds=run.rounds,
        timing_cases=TIMING_CASES,
        verified_cases=len(expected.cases),
        kernels=tuple(_figures(bench, study, expected, kinds, host, timing) for study in studies),
        growth=tuple(growth_of(bench, studies, target, timing, expected, seconds)),
        calls=tuple(time_calls(bench, called, target, expected, seconds)),
    )


def _verified(
    bench: Workbench, found: Sequence[Subject], target: Target, scene: str, model: str
) -> tuple[list[Study], Expected]:
    candidates = bench.prepare([s.variant for s in found], target)
    bench.compile(candidates)
    expected = bench.expected(scene, model, STEPS, VERIFY_SEED, VERIFY_RANDOM)
    bench.verify(candidates, expected)
    studies = [Study(s, c) for s, c in zip(found, candidates, strict=True)]
    if not studies or studies[0].subject.role != BASELINE or studies[0].candidate.rejected:
        reason = studies[0].candidate.rejected if studies else "no subject"
        raise KernelError(f"{BASELINE}: {reason}")
    return studies, expected


def _figures(
    bench: Workbench,
    study: Study,
    expected: Expected,
    kinds: dict[str, dict[str, float]],
    host: Host,
    timing: Array,
) -> KernelFigures:
    candidate, found = study.candidate, study.profile
    missing = dict(found.missing) if found else {}
    if candidate.rejected:
        missing["kernel"] = candidate.rejected
    stepper = study.subject.variant.stepper
    return KernelFigures(
        role=study.subject.role,
        name=candidate.name,
        steps=stepper.steps,
        budget=stepper.budget,
        timed=study.timed,
        verified_error=candidate.verdict.max_rel_error if candidate.verdict else None,
        error=study.accuracy.largest if study.accuracy else None,
        outputs=study.accuracy.outputs if study.accuracy else {},
        worst=study.accuracy.worst if study.accuracy else None,
        kinds=_kinds(study, expected, kinds),
        counts=found.counts if found else None,
        sections=found.sections if found else None,
        misses=found.misses if found else (),
        modelled=modelled(bench, study.subject.variant, host, timing) if found else (),
        missing=missing,
    )


def _kinds(
    study: Study, expected: Expected, times: dict[str, dict[str, float]]
) -> dict[str, KindFigures]:
    if study.accuracy is None or study.profile is None or not study.profile.each:
        return {}
    each = np.array(study.profile.each, dtype=float)
    return {
        kind: KindFigures(
            cases=len(rows),
            error=float(study.accuracy.by_case[rows].max()),
            ns=times.get(kind, {}).get(study.candidate.name),
            evaluations=float(each[rows].mean()),
        )
        for kind, rows in kinds_of(expected.labels).items()
    }
