"""The numbers that go into a collision and come out of it, as data."""

from __future__ import annotations

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
    """The numbers of a case and of an outcome, by name and in their order."""

    parameters: tuple[str, ...]
    motion: tuple[str, ...]  # positions, directions and velocities before
    velocities: tuple[str, ...]  # after; an outcome's status follows them

    @property
    def case(self) -> tuple[str, ...]:
        return (*self.parameters, *self.motion)

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
