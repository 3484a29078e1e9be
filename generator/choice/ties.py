"""The one rule of ties, and the one function that picks.

Two timings of the same kernel differ by 1 %. So what takes no more than `NEGLIGIBLE` of the fastest
may be chosen, and of that the kernel with the fewest options away from the default is, then the
first by name. What takes no more than `WON` is named a tie, as is what the timing cannot tell from
the fastest: what one timing may choose, the next names a tie.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ..evidence.records.evidence import NEGLIGIBLE, WON
from ..registry.names import name_of
from ..registry.variant import Variant


@dataclass(frozen=True)
class Standing:
    """How a kernel stands to the fastest of its contest."""

    variant: Variant
    ratio: float  # of its time to that of the fastest
    apart: bool = True  # can it be told from the fastest?

    @property
    def name(self) -> str:
        return name_of(self.variant)

    @property
    def ties(self) -> bool:
        return not self.apart or self.ratio <= WON


def pick(standings: Iterable[Standing], limit: float = NEGLIGIBLE) -> Variant:
    """The kernel to choose. `limit`: of the fastest's time, by which nothing is lost."""
    close = (each for each in standings if each.ratio <= limit)
    return min(close, key=lambda s: (s.variant.distance_from_default(), s.name)).variant
