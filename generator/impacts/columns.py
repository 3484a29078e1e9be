"""The numbers that go into a collision and come out of it, as data."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Parameter:
    """A number that a collision is given besides its motions."""

    name: str
    unit: str
    low: float  # what the mechanics admits whatever the scene
    high: float
    meaning: str  # with its unit, as a member of a struct is explained


@dataclass(frozen=True)
class Columns:
    """The numbers of a case and of an outcome, by name and in their order.

    A speed is what is named v.. (m/s), a spin what is named w.. (1/s): times the radius it is a
    speed too. Both names may stand before and after.
    """

    parameters: tuple[str, ...]
    motion: tuple[str, ...]  # positions, directions and velocities before
    velocities: tuple[str, ...]  # after; an outcome's status follows them
    radius: str = "R"  # the parameter that spins are multiplied by

    @property
    def case(self) -> tuple[str, ...]:
        return (*self.parameters, *self.motion)

    @property
    def speeds(self) -> tuple[int, ...]:
        """Columns of a case."""
        return _begin_with("v", self.case)

    @property
    def spins(self) -> tuple[int, ...]:
        """Columns of a case."""
        return _begin_with("w", self.case)

    @property
    def spins_after(self) -> tuple[int, ...]:
        """Columns of an outcome."""
        return _begin_with("w", self.velocities)

    @property
    def before(self) -> tuple[int, ...]:
        """Columns of a case that an outcome's velocities replace, in their order."""
        return tuple(self.case.index(name) for name in self.velocities)

    @property
    def status(self) -> int:
        """The column of an outcome that holds its status."""
        return len(self.velocities)

    @property
    def sticks(self) -> int:
        """The column of an expected outcome that says whether the contact sticks."""
        return self.status + 1

    @property
    def outcome_width(self) -> int:
        return self.status + 1

    @property
    def expected_width(self) -> int:
        return self.sticks + 1


def _begin_with(letter: str, names: Iterable[str]) -> tuple[int, ...]:
    return tuple(n for n, name in enumerate(names) if name.startswith(letter))
