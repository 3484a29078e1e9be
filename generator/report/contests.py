"""Out of the trials of a sweep: contests, Pareto fronts, and what each option does by itself."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from ..evidence.timing.ratios import median_interval
from ..registry.axes import axis
from ..sweep.record import Final, Run, Trial
from .data import Contest, Effect, SweepSummary, VariantPoint

MORE_EXACT = 0.99  # a front goes on where an error is less by 1 %: last digits are not exactness
EXACT, SCHEME = "the exact result", "the same scheme in long double"


def latest(trials: Iterable[Trial]) -> dict[tuple[str, str], Trial]:
    """The trial of each variant of a contest that counts.

    The newest; of the same sources, compiler, cases and rules, the one that was timed the longest.
    """
    found: dict[tuple[str, str], Trial] = {}
    for trial in trials:  # oldest first
        key = trial.subject.contest, trial.subject.name
        last = found.get(key)
        if last is None or trial.rung >= last.rung or not _asks_the_same(trial, last):
            found[key] = trial
    return found


def _asks_the_same(one: Trial, other: Trial) -> bool:
    if one.depends is None or other.depends is None:
        return one.depends is other.depends
    return set(one.depends.differences(other.depends)) <= {"timing"}


def summary_of(runs: Sequence[Run], trials: Sequence[Trial]) -> SweepSummary:
    kept = latest(trials)
    known = kept.values()
    rejected: dict[str, int] = defaultdict(int)
    examples: dict[str, str] = {}
    for trial in known:
        if trial.rejection is not None:
            rejected[trial.rejection.reason] += 1
            text = f"{trial.subject.name}: {trial.rejection.text}"
            examples.setdefault(trial.rejection.reason, text)
    times = sorted(trial.made_at for trial in trials)
    return SweepSummary(
        commands=tuple(dict.fromkeys(run.command for run in runs)),
        from_to=(times[0], times[-1]) if times else None,
        trials=len(trials),
        variants=len(known),
        timed=sum(trial.times is not None for trial in known),
        longer=sum(_has_successor(trial, kept) for trial in trials),
        outdated=sum(_is_outdated(trial, kept) for trial in trials),
        rejected=dict(sorted(rejected.items())),
        examples=examples,
    )


def _has_successor(trial: Trial, kept: dict[tuple[str, str], Trial]) -> bool:
    """Was the same question answered again, for longer?"""
    last = kept[trial.subject.contest, trial.subject.name]
    return trial.id != last.id and _asks_the_same(trial, last)


def _is_outdated(trial: Trial, kept: dict[tuple[str, str], Trial]) -> bool:
    """Was the variant tried again with other sources, compiler, cases or rules?"""
    return not _asks_the_same(trial, kept[trial.subject.contest, trial.subject.name])


def contests_of(trials: Iterable[Trial], finals: dict[str, Final]) -> list[Contest]:
    """Every contest with a timed variant: fixed steps first, then the budgets, largest first."""
    by_contest: dict[str, list[Trial]] = defaultdict(list)
    for (contest, _), trial in latest(trials).items():
        if trial.times is not None and trial.rejection is None:
            by_contest[contest].append(trial)
    made = [_contest(name, found, finals.get(name)) for name, found in by_contest.items()]
    return sorted(made, key=_order)


def _order(contest: Contest) -> tuple[bool, bool, float]:
    budget = 0.0 if contest.family == "euler" else float(contest.goal.removeprefix("E = "))
    return contest.call == "batch", contest.family != "euler", -budget


def _contest(name: str, trials: list[Trial], final: Final | None) -> Contest:
    first = trials[0].subject
    euler = first.steps is not None
    ties = set(final.ties) if final else set()
    axes = tuple(dict.fromkeys(key for trial in trials for key in trial.subject.options))
    points = sorted(
        (_point(trial, axes, ties) for trial in trials), key=lambda p: (p.ratio, p.error, p.name)
    )
    return Contest(
        name=name,
        goal=f"N = {first.steps}" if euler else f"E = {first.budget:.0e}",
        call=first.call,
        family="euler" if euler else "exact",
        against=SCHEME if euler else EXACT,
        axes=axes,
        band=_band(points, final),
        variants=_with_front(points),
    )


def _point(trial: Trial, axes: Sequence[str], ties: set[str]) -> VariantPoint:
    """An axis that a variant has not, as those of lanes, is an empty code."""
    assert trial.times is not None
    error = trial.errors.max_rel_error if trial.errors else None
    return VariantPoint(
        name=trial.subject.name,
        stepper=trial.subject.stepper,
        width=trial.subject.width,
        options=tuple(trial.subject.options.get(key, "") for key in axes),
        ns=trial.times.ns,
        ratio=trial.times.ratio,
        ratio_ci=trial.times.ratio_ci,
        error=error if error is not None else float("nan"),
        rung=trial.rung,
        tie=trial.subject.name in ties,
        front=False,
    )


def _band(points: Sequence[VariantPoint], final: Final | None) -> tuple[float, float] | None:
    """About the mark of the final's fastest kernel, as far as the A/A control goes to either side.

    About its mark, not its ratio in the final: that was taken at another time, in other company.
    """
    fastest = next((p for p in points if final and p.name == final.fastest), None)
    if final is None or fastest is None:
        return None
    low, high = final.control
    return fastest.ratio * low, fastest.ratio * high


def _with_front(points: Sequence[VariantPoint]) -> tuple[VariantPoint, ...]:
    """`points` fastest first: those more exact than all faster ones are on the front."""
    least, found = float("inf"), []
    for point in points:
        front = point.error < MORE_EXACT * least
        least = min(least, point.error) if front else least
        found.append(replace(point, front=front))
    return tuple(found)


def effects_of(contests: Iterable[Contest], only: str | None = None) -> list[Effect]:
    """For each pair of codes of an axis: the ratio of times over variants equal in all else.

    `only`: this axis alone. Contests of a family are taken together, pairs never cross contests.
    """
    ratios: dict[tuple[str, str, str, str], list[float]] = defaultdict(list)
    for contest in contests:
        for index, key in enumerate(contest.axes):
            if only is None or key == only:
                for code, other, ratio in _pairs(contest, index):
                    ratios[contest.family, key, code, other].append(ratio)
    return [_effect(*key, values) for key, values in sorted(ratios.items(), key=_effect_order)]


def _pairs(contest: Contest, index: int) -> list[tuple[str, str, float]]:
    groups: dict[object, dict[str, float]] = defaultdict(dict)
    for v in contest.variants:
        rest = (v.stepper, v.width, *v.options[:index], *v.options[index + 1 :])
        groups[rest][v.options[index]] = v.ratio
    default = _codes(contest.axes[index])
    found = []
    for times in groups.values():
        ranked = sorted(times, key=lambda code: default.get(code, len(default)))
        for n, other in enumerate(ranked):
            found += [(code, other, times[code] / times[other]) for code in ranked[n + 1 :]]
    return found


def _codes(key: str) -> dict[str, int]:
    """Codes of an axis in its order; empty where the registry has no such axis any more."""
    try:
        return {code: n for n, code in enumerate(axis(key).codes())}
    except KeyError:
        return {}


def _effect_order(item: tuple[tuple[str, str, str, str], list[float]]) -> tuple[object, ...]:
    (family, key, code, other), _ = item
    codes = _codes(key)
    return family, key, codes.get(other, 99), codes.get(code, 99)


def _effect(family: str, key: str, code: str, other: str, ratios: list[float]) -> Effect:
    try:
        texts = {choice.code: choice.text for choice in axis(key).choices}
        text = f"{axis(key).text}: {texts.get(code, code)}; instead of {texts.get(other, other)}"
    except KeyError:
        text = "of an older registry"
    values = np.array(ratios)
    low, high = median_interval(values)
    return Effect(
        family=family,
        axis=key,
        code=code,
        other=other,
        text=text,
        pairs=len(ratios),
        ratio=float(np.median(values)),
        ratio_ci=(low, high),
    )
