"""Successive halving: many kernels timed shortly, the better of them longer, the best together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ..choice.trials import Times, Trial
from ..registry.variant import Variant

RUNGS = (24, 96, 384)  # rounds of a timing
KEPT = 4  # the best one in so many goes to the next rung
FINALISTS = 32
QUIET = 0.5  # share of the rounds that count: it is 1 where enough were quiet
_PLAUSIBLE = 1.05  # what may still be the fastest: up to so much over the best seen


@dataclass
class Entry:
    """A variant with its trials, one a rung."""

    variant: Variant
    trials: list[Trial] = field(default_factory=list)

    @property
    def rung(self) -> int:
        return len(self.trials) - 1

    @property
    def last(self) -> Trial:
        return self.trials[-1]

    @property
    def least(self) -> Times:
        """The timing with the lowest ratio: other work costs a kernel more than the baseline.

        A kernel that was disturbed in its longest timing alone still gets into the final.
        """
        return min((t.times for t in self.trials if t.times is not None), key=lambda t: t.ratio)

    @property
    def ratio(self) -> float:
        """To the baseline, the least that was seen."""
        return self.least.ratio

    @property
    def low(self) -> float:
        """The lower end of the ratio's interval."""
        return self.least.ratio_ci[0]

    @property
    def disturbed(self) -> bool:
        """Had its only timing, the shortest, other work beside it on the core?

        The interval tells nothing of what that costs; a longer timing comes at another moment.
        """
        quiet = self.least.quiet
        return self.rung == 0 and quiet is not None and quiet < QUIET


def eligible(entry: Entry) -> bool:
    """May it be chosen? Timed to the end, and with IEEE arithmetic (-Ofast is the report's)."""
    timed = bool(entry.trials) and entry.last.times is not None
    return timed and entry.variant.rounds_as_written


def by_ratio(entries: Sequence[Entry]) -> list[Entry]:
    """Eligible entries, fastest first; equal ones in the order of their names."""
    return sorted(filter(eligible, entries), key=lambda e: (e.ratio, e.last.subject.name))


def promoted(entries: Sequence[Entry], rung: int) -> list[Entry]:
    """Those that shall be timed on the next rung: of a rung's best quarter, who was not yet.

    And who may be the best by the interval of its ratio, or was disturbed: on a busy machine 24
    rounds tell little.
    """
    there = [e for e in entries if e.rung >= rung and eligible(e)]

    def ratio_there(entry: Entry) -> float:
        times = entry.trials[rung].times
        return times.ratio if times is not None else float("inf")

    ranked = sorted(there, key=lambda e: (ratio_there(e), e.last.subject.name))
    quarter = -(-len(ranked) // KEPT)
    best = min((e.ratio for e in there), default=0.0)
    chosen = ranked[:quarter] + [e for e in ranked[quarter:] if e.low < best or e.disturbed]
    return [e for e in chosen if e.rung == rung]


def finalists(entries: Sequence[Entry], count: int = FINALISTS) -> list[Entry]:
    """Who is timed in the final: all that may still be the fastest, eight at least if there are.

    Where those are too many, the fastest eight and then those with the fewest options away from the
    default, since of ties that is the one to be chosen.
    """
    ranked = by_ratio(entries)
    if not ranked:
        return []
    limit = min(e.ratio for e in ranked) * _PLAUSIBLE
    least = min(8, count)
    surest, rest = ranked[:least], [e for e in ranked[least:] if e.low <= limit]
    rest.sort(key=lambda e: (e.variant.distance_from_default(), e.ratio, e.last.subject.name))
    return by_ratio(surest + rest[: count - least])
