"""How far the measuring of a report is, and how long the rest will take."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

Progress = Callable[[str, int, int], None]  # what, done, of


@dataclass
class Schedule:
    """Stages one after the other. `planned`: seconds of each, a guess until some have passed.

    The guess for those to come is scaled by what those before have taken of theirs.
    """

    planned: tuple[float, ...]
    show: Progress
    clock: Callable[[], float] = time.monotonic
    stage: int = -1
    started: list[float] = field(default_factory=list)

    def next(self) -> None:
        """The next stage begins."""
        self.stage += 1
        self.started.append(self.clock())

    def __call__(self, what: str, done: int, of: int) -> None:
        """A stage tells how far it is: shown with its number and with the time that is left."""
        head = f"[{self.stage + 1} of {len(self.planned)}] {what}"
        self.show(f"{head} (about {_minutes(self.left())} left)", done, of)

    def left(self) -> float:
        """Seconds to the end."""
        now = self.clock()
        passed = sum(self.planned[: self.stage])
        scale = (self.started[self.stage] - self.started[0]) / passed if passed else 1.0
        under_way = max(scale * self.planned[self.stage] - (now - self.started[self.stage]), 0.0)
        return under_way + scale * sum(self.planned[self.stage + 1 :])


def _minutes(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"
