"""Out of the trials of a sweep: who took part in each contest, who is on its front, and why not."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..choice.trials import Final, Times, Trial
from ..evidence.timing.ratios import Interval

MORE_EXACT = 0.99  # a front goes on where an error is less by 1 %: last digits are not exactness
EXACT, SCHEME = "the exact result", "the same scheme in long double"


@dataclass(frozen=True)
class Entrant:
    """A variant that was timed. `why`: of one faster than the chosen, why it was not chosen."""

    trial: Trial
    times: Times
    tie: bool = False
    front: bool = False
    chosen: bool = False
    why: str = ""

    @property
    def name(self) -> str:
        return self.trial.subject.name

    @property
    def ratio(self) -> float:
        return self.times.ratio

    @property
    def error(self) -> float:
        found = self.trial.errors.max_rel_error if self.trial.errors else None
        return float("nan") if found is None else found

    def options(self, axes: Sequence[str]) -> tuple[str, ...]:
        """Its codes; an axis that it has not, as those of lanes, is an empty one."""
        return tuple(self.trial.subject.options.get(key, "") for key in axes)

    def row(self, axes: Sequence[str]) -> dict[str, Any]:
        subject, times = self.trial.subject, self.times
        return {
            "name": self.name,
            "stepper": subject.stepper,
            "width": subject.asked.width.lanes,
            "options": self.options(axes),
            **{key: getattr(times, key) for key in ("ns", "ratio", "ratio_ci")},
            "error": self.error,
            "rung": self.trial.rung,
            **{key: getattr(self, key) for key in ("tie", "front", "chosen", "why")},
            "standing": ", ".join(k for k in ("chosen", "front", "tie") if getattr(self, k)),
        }


@dataclass(frozen=True)
class ContestTable:
    """A contest as the page has it: its variants, the fastest first."""

    name: str
    goal: str
    call: str
    family: str
    against: str  # what the errors are taken against
    axes: tuple[str, ...]
    band: Interval | None  # ratios that cannot be told from the fastest
    variants: tuple[Entrant, ...]

    def row(self) -> dict[str, Any]:
        keys = ("name", "goal", "call", "family", "against", "axes", "band")
        variants = [entrant.row(self.axes) for entrant in self.variants]
        return {**{key: getattr(self, key) for key in keys}, "variants": variants}


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


def summary_of(trials: Sequence[Trial]) -> dict[str, Any]:
    """How many trials and variants there are, and why which are not shown."""
    kept = latest(trials)
    examples: dict[str, str] = {}
    rejected: dict[str, int] = defaultdict(int)
    for trial in kept.values():
        if trial.rejection is not None:
            rejected[trial.rejection.reason] += 1
            text = f"{trial.subject.name}: {trial.rejection.text}"
            examples.setdefault(trial.rejection.reason, text)
    last = [kept[trial.subject.contest, trial.subject.name] for trial in trials]
    same = [_asks_the_same(trial, other) for trial, other in zip(trials, last, strict=True)]
    again = [trial.id != other.id for trial, other in zip(trials, last, strict=True)]
    return {
        "trials": len(trials),
        "variants": len(kept),
        "timed": sum(trial.times is not None for trial in kept.values()),
        # timed again for longer; tried again with other sources, compiler, cases or rules
        "longer": sum(a and b for a, b in zip(same, again, strict=True)),
        "outdated": same.count(False),
        "rejected": dict(sorted(rejected.items())),
        "examples": examples,
    }


def contests_of(trials: Iterable[Trial], finals: Mapping[str, Final]) -> list[ContestTable]:
    """Every contest with a timed variant: fixed steps first, then the budgets, largest first."""
    by_contest: dict[str, list[Entrant]] = defaultdict(list)
    for (contest, _), trial in latest(trials).items():
        if trial.times is not None and trial.rejection is None:
            by_contest[contest].append(Entrant(trial, trial.times))
    made = [_contest(name, found, finals.get(name)) for name, found in by_contest.items()]
    return sorted(made, key=_order)


def _order(contest: ContestTable) -> tuple[bool, bool, float]:
    budget = 0.0 if contest.family == "euler" else float(contest.goal.removeprefix("E = "))
    return contest.call == "batch", contest.family != "euler", -budget


def _contest(name: str, found: list[Entrant], final: Final | None) -> ContestTable:
    contest = found[0].trial.subject.asked.contest
    goal = contest.goal
    euler = goal.steps is not None
    found = sorted(found, key=lambda e: (e.ratio, e.error, e.name))
    if final is not None:
        found = _judged(found, final)
    return ContestTable(
        name=name,
        goal=f"N = {goal.steps}" if euler else f"E = {goal.budget:.0e}",
        call=contest.call,
        family="euler" if euler else "exact",
        against=SCHEME if euler else EXACT,
        axes=tuple(dict.fromkeys(key for e in found for key in e.trial.subject.options)),
        band=_band(found, final),
        variants=_with_front(found),
    )


def _judged(found: Sequence[Entrant], final: Final) -> list[Entrant]:
    """With what the final says of each."""
    ratio = next((e.ratio for e in found if e.name == final.chosen), 0.0)
    return [
        replace(
            entrant,
            tie=entrant.name in final.ties,
            chosen=entrant.name == final.chosen,
            why=_why_not(entrant.trial, final) if entrant.ratio < ratio else "",
        )
        for entrant in found
    ]


def _why_not(trial: Trial, final: Final) -> str:
    """Why a variant whose mark is faster than the chosen one's was not chosen."""
    by_name = {row.subject.name: row for row in final.finalists}
    own, chosen = by_name.get(trial.subject.name), by_name.get(final.chosen)
    if own is None:
        if trial.made_at > final.made_at:
            return "was timed after the final"
        return f"was not among the {len(by_name)} of the final, which were timed for longer"
    if own.tie and chosen and own.distance >= chosen.distance:
        return (
            "ties with the fastest in the final; of ties the one with the fewest options from "
            f"the default is chosen, which has {chosen.distance} and this one {own.distance}"
        )
    low, high = own.to_fastest_ci
    return (
        f"took {own.to_fastest:.4g} ({low:.4g} to {high:.4g}) of the fastest's time in the final, "
        "where all are timed in turn in the same processes"
    )


def _band(found: Sequence[Entrant], final: Final | None) -> Interval | None:
    """About the mark of the final's fastest kernel, as far as the A/A control goes to either side.

    About its mark, not its ratio in the final: that was taken at another time, in other company.
    """
    fastest = next((e for e in found if final and e.name == final.fastest), None)
    if final is None or fastest is None:
        return None
    low, high = final.control
    return fastest.ratio * low, fastest.ratio * high


def _with_front(found: Sequence[Entrant]) -> tuple[Entrant, ...]:
    """`found` fastest first: those more exact than all faster ones are on the front."""
    least, marked = float("inf"), []
    for entrant in found:
        front = entrant.error < MORE_EXACT * least
        least = min(least, entrant.error) if front else least
        marked.append(replace(entrant, front=front))
    return tuple(marked)
