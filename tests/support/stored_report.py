"""A sweep's store and measurements made up for tests: known effects, plausible sizes."""

from __future__ import annotations

import sqlite3
from dataclasses import dataclass
from pathlib import Path
from random import Random

from generator.choice.trials import (
    Depends,
    Errors,
    Final,
    Finalist,
    Rejection,
    Run,
    Subject,
    Times,
    Trial,
    trial_key,
)
from generator.evidence.profiling.counting import KINDS
from generator.evidence.profiling.sections import SECTIONS
from generator.evidence.timing.ratios import TimingResult
from generator.impacts.ball_ball.evidence.measure import CASE_NAMES, OUTCOME_NAMES
from generator.registry.names import name_of
from generator.registry.question import DEFAULT_IMPACT, Contest, Goal
from generator.registry.variant import Stepper, Variant, fixed_steps, make_variant
from generator.report.experiments.subjects import BASELINE, BEST, EULER, role_of_budget
from generator.report.findings import (
    CallPoint,
    Counts,
    Findings,
    GrowthPoint,
    KernelFindings,
    KindFindings,
    MissFigures,
    Modelled,
    SectionShares,
    WorstInput,
    sources_hash,
)
from generator.sweep.space import Space
from generator.sweep.store import opened
from generator.targets.target import find_target

SCENE, MODEL = "any", "mathavan2014"
NS = 20_000.0  # of paper-initial
# What an option does to the time; all others do nothing.
EFFECTS = {"ahead": 0.5, "est1": 0.7, "clang": 1.25, "chosen": 0.8}
AT = "2026-01-02T03:04:05.000Z"


@dataclass(frozen=True)
class MadeStore:
    path: Path
    trials: int
    rejected: int


def ratio_of(variant: Variant) -> float:
    ratio = 1.0 if variant.stepper.family == "fixed" else 0.02
    for _, code in variant.options:
        ratio *= EFFECTS.get(code, 1.0)
    return ratio


def _contests(target: str) -> list[Contest]:
    fixed, goals = Goal(steps=1000), (Goal(budget=1e-3), Goal(budget=1e-6))
    held = (DEFAULT_IMPACT, target, SCENE, MODEL)
    singles = [Contest(*held, goal, "scalar") for goal in (fixed, *goals)]
    return [*singles, Contest(*held, fixed, "batch")]


def _variants(contest: Contest, count: int, random: Random) -> list[Variant]:
    compilers = ("gcc", "clang", "clangold")
    space = Space(contest, find_target(contest.target), compilers, (1,), {})
    rows = list(space.everything()) if contest.goal.steps is None else []
    if contest.goal.steps is not None:
        start = make_variant(contest.target, SCENE, MODEL, fixed_steps(1000))
        start = start.with_options(flags="strict")
        found = {name_of(start): start}
        while len(found) < count:  # neighbours, so that pairs differ in one option alone
            near = space.neighbours(random.choice(list(found.values())))
            found |= {name_of(v): v for v in random.sample(list(near), min(4, len(near)))}
        rows = list(found.values())
    if contest.batches:
        rows = [_with_lanes(v, 2 if n % 2 else 4) for n, v in enumerate(rows)]
    return rows[:count]


def _with_lanes(variant: Variant, width: int) -> Variant:
    """Their own options have their defaults. Legal or not: nothing is built."""
    options = dict(variant.options)
    return make_variant(variant.target, SCENE, MODEL, variant.stepper, width, **options)


def _times(variant: Variant, random: Random) -> Times:
    ratio = ratio_of(variant)
    return Times(
        ns=ratio * NS,
        cycles=ratio * NS * 2.1,
        ratio=ratio,
        ratio_ci=(ratio * 0.98, ratio * 1.02),
        control=(0.99, 1.01),
        baseline_ns=NS,
        rounds=32,
        ratios=tuple(ratio * (1 + 0.01 * random.random()) for _ in range(32)),
    )


def _errors(variant: Variant, random: Random) -> Errors:
    exact = variant.stepper.budget is not None
    size = (variant.stepper.budget or 1e-6) * (0.2 + 0.7 * random.random())
    return Errors(
        passed=True,
        reason="within",
        max_abs_error=size,
        max_rel_error=size,
        against="exact" if exact else "euler",
        cases=5950,
        flips=0,
        worst_case=1,
        max_flip_error=0.0,
        sticking=0,
        max_sticking_rel_error=0.0,
    )


def _trial(run: Run, contest: Contest, variant: Variant, random: Random, rejected: bool) -> Trial:
    subject = Subject.of(variant)
    depends = Depends(
        source=name_of(variant),
        compiler=f"{variant['compiler']} 1",
        flags="-O3",
        cpu="made up",
        goal=str(variant.stepper.goal),
        call=contest.call,
        cases="c",
        answers="a",
        rules="r",
        bench="b",
        baseline="p",
        timing="t",
    )
    return Trial(
        key=trial_key(depends, 0),
        run=run.id,
        made_at=AT,
        machine="made-up",
        subject=subject,
        depends=depends,
        rung=0,
        rejection=Rejection(reason="wrong result", text="off by 1") if rejected else None,
        build_seconds=1.0,
        errors=None if rejected else _errors(variant, random),
        times=None if rejected else _times(variant, random),
    ).sealed()


def _final(run: Run, contest: Contest, trials: list[Trial]) -> Final:
    best = sorted((t for t in trials if t.times), key=lambda t: t.times.ratio)[:5]  # type: ignore[union-attr]
    finalists = tuple(
        Finalist(
            subject=t.subject,
            times=t.times,
            to_fastest=t.times.ratio / best[0].times.ratio,  # type: ignore[union-attr]
            to_fastest_ci=(0.99, 1.01),
            distance=1,
            max_rel_error=t.errors.max_rel_error,  # type: ignore[union-attr]
            tie=n < 2,
        )
        for n, t in enumerate(best)
    )
    return Final(
        key=str(contest),
        run=run.id,
        made_at=AT,
        machine="made-up",
        contest=str(contest),
        purpose="choice",
        chosen=best[0].subject.name,
        fastest=best[0].subject.name,
        finalists=finalists,
        rounds=100,
        processes=1,
        control=(0.98, 1.02),
    ).sealed()


def make_store(path: Path, target: str, count: int, seed: int = 1) -> MadeStore:
    """A store with about `count` trials in four contests; one in nine was rejected."""
    random = Random(seed)
    run = Run(
        key="run",
        run="run",
        made_at=AT,
        machine="made-up",
        command="./gen sweep --minutes 19",
        seed=1,
        cpu="made up",
        target=target,
        compilers={"gcc": "g++ 12", "clang": "clang 19", "clangold": "clang 14"},
        system="Linux",
        version="0",
    ).sealed()
    records: list[Run | Trial | Final] = [run]
    rejected = 0
    for contest in _contests(target):
        wanted = count // 2 if contest.goal.steps else 60
        trials = []
        for n, variant in enumerate(_variants(contest, wanted, random)):
            trials.append(_trial(run, contest, variant, random, n % 9 == 8))
            rejected += n % 9 == 8
        records += [*trials, _final(run, contest, trials)]
    with opened(path):
        pass  # makes the table
    with sqlite3.connect(path) as connection:  # one transaction instead of thousands
        rows = [(r.id, r.kind, r.key, r.made_at, r.model_dump_json()) for r in records]
        connection.executemany("INSERT OR IGNORE INTO record VALUES (?, ?, ?, ?, ?)", rows)
    return MadeStore(path, sum(isinstance(r, Trial) for r in records), rejected)


def _kernel(role: str, variant: Variant, random: Random) -> KernelFindings:
    ratio = ratio_of(variant)
    operations = {k: random.randint(0, 40) for k in KINDS if k not in ("call", "rare")}
    values = tuple(random.random().hex() for _ in OUTCOME_NAMES)
    return KernelFindings(
        role=role,
        name=name_of(variant),
        steps=variant.stepper.steps,
        budget=variant.stepper.budget,
        timed=TimingResult(
            name=name_of(variant),
            ns=ratio * NS,
            cycles=ratio * NS * 2.1,
            ratio=ratio,
            ratio_ci=(0.99 * ratio, 1.01 * ratio),
            latency_ns=None,
            seed_ns=ratio * NS,
        ),
        seed_cycles=ratio * NS * 2.1,
        verified_error=7e-7,
        error=0.1 if variant.stepper.steps else variant.stepper.budget,
        outputs={name: random.random() * 1e-6 for name in OUTCOME_NAMES},
        worst=WorstInput(
            label="random 7 (sticks)",
            error=1e-3,
            inputs=tuple(random.random().hex() for _ in CASE_NAMES),
            got=values,
            exact=values,
        ),
        kinds={
            kind: KindFindings(cases=20, error=1e-7, ns=random.random() * 1e4, evaluations=12.5)
            for kind in ("sticks", "grazing", "flip")
        },
        counts=Counts(
            per_collision={k: 1000.5 * n for k, n in operations.items()},
            per_step=operations,
            stated="1 add",
            evaluations=1001.5,
            flops=56_000.0,
            refused=0.01,
        ),
        sections=SectionShares(
            shares=dict(zip(SECTIONS, (0.1, 0.5, 0.3, 0.1), strict=True)), unknown=0.0, samples=9000
        ),
        misses=(
            MissFigures(
                source="valgrind's simulation",
                by="valgrind-3",
                built_for="x86-64-v3",
                events={"branch_misses": 7.25},
            ),
        ),
        modelled=tuple(
            Modelled(
                target=name,
                cpu=name,
                cycles=35.5,
                bound=20.25,
                uops=60.0,
                ipc=2.0,
                bottleneck="waits for results",
                pressure=(("FP0", 20.25), ("FP1", 19.5)),
                collision=36_000.5,
                note="the loop",
            )
            for name in ("zen3", "x86-64-v3")
        ),
        missing={"hardware counters": "not here"},
    )


def make_findings(target: str, seed: int = 1) -> Findings:
    """Measurements of the report's kernels and of three chosen ones."""
    random = Random(seed)
    euler = fixed_steps(1000)

    def made(stepper: Stepper, **options: str) -> Variant:
        return make_variant(target, SCENE, MODEL, stepper, **options)

    rows = {
        BASELINE: made(euler, flags="report"),
        BEST: made(euler, flags="report", rsqrt="est1"),
        EULER: made(euler, rsqrt="ahead"),
        role_of_budget(1e-3): made(Stepper("dp54", budget=1e-3)),
        role_of_budget(1e-6): made(Stepper("dp54", budget=1e-6), root="est1"),
    }
    return Findings(
        made_at=AT,
        sources=sources_hash(),
        command="./gen report --measure",
        cpu="made up",
        target=target,
        scene=SCENE,
        model=MODEL,
        compilers={"gcc": "g++ 12", "clang": "clang 19"},
        flags=dict.fromkeys(rows, "-O3"),
        seeds={"verification": 20141, "timing": 7735},
        tsc_ghz=2.1,
        control=(0.99, 1.01),
        rounds=100,
        timing_cases=4096,
        verified_cases=5950,
        kernels=tuple(_kernel(role, variant, random) for role, variant in rows.items()),
        growth=tuple(
            GrowthPoint(role=role, steps=n, ns=20.0 * n, error=0.1, slipping_error=1.0 / n)
            for role in (BASELINE, EULER)
            for n in (10, 100, 1000, 10_000)
        ),
        calls=tuple(
            CallPoint(
                role=EULER,
                kernel=name_of(rows[EULER]),
                width=width,
                call="batch" if width > 1 else "scalar",
                timed=TimingResult(
                    name="0",
                    ns=9000.0 / width,
                    cycles=9000.0 / width,
                    ratio=1.0 / width,
                    ratio_ci=(0.99 / width, 1.01 / width),
                    latency_ns=None,
                ),
            )
            for width in (1, 4)
        ),
    )
