"""Records made up for tests."""

from __future__ import annotations

from generator.choice.trials import Depends, Errors, Subject, Times, Trial, trial_key

DEPENDS = Depends(
    source="5" * 16,
    compiler="g++ 12.2.0",
    flags="-O3",
    cpu="zen3, AMD Ryzen",
    goal="n1000",
    call="scalar",
    cases="c" * 16,
    answers="a" * 32,
    rules="7" * 32,
    bench="b" * 16,
    baseline="0" * 16,
    timing="rounds 24",
)


def subject(**options: str) -> Subject:
    question = "ball-ball/zen3/any/pooltool-n1000-x1"
    return Subject(question=question, recipe="fixed", options=options)


def trial(ratio: float, rung: int = 0, depends: Depends = DEPENDS, **options: str) -> Trial:
    """A timed trial; other `depends` or another rung give it another key."""
    errors = Errors(
        passed=True,
        reason="within 1e-9",
        max_abs_error=1e-10,
        max_rel_error=1e-11,
        against="euler",
        cases=5950,
        flips=0,
        worst_case=3,
        max_flip_error=0.0,
        sticking=0,
        max_sticking_rel_error=0.0,
    )
    times = Times(
        ns=1e4 * ratio,
        cycles=3e4 * ratio,
        ratio=ratio,
        ratio_ci=(0.99 * ratio, 1.01 * ratio),
        control=(0.995, 1.005),
        baseline_ns=1e4,
        rounds=3,
        ratios=(0.99 * ratio, ratio, 1.01 * ratio),
    )
    made = Trial(
        key=trial_key(depends, rung),
        run="r1",
        made_at="2026-01-01T00:00:00Z",
        machine="here",
        subject=subject(**options),
        depends=depends,
        rung=rung,
        rejection=None,
        build_seconds=0.5,
        errors=errors,
        times=times,
    )
    return made.sealed()
