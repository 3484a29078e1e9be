"""One impact of a vendored folder: what its typed header and its self-test show."""

from __future__ import annotations

from dataclasses import dataclass

from ..emission.header import Section
from .golden import GoldenRow
from .request import VendorRequest


@dataclass(frozen=True)
class PartContext(Section):
    """What templates see of one impact. `request`: that of the impact alone."""

    request: VendorRequest
    rows: tuple[GoldenRow, ...]
    dispatched: bool

    @property
    def fixed_step(self) -> bool:
        return self.request.fixed_step

    @property
    def single_header(self) -> bool:
        return self.request.single_header

    @property
    def typed(self) -> str:
        """The template of its part of the typed header."""
        return f"{self.impact.folder}/typed.hpp.j2"

    @property
    def selftest(self) -> str:
        """The name of its self-test without what follows the dot."""
        return f"{self.prefix}_{self.abi.prefix}selftest"

    @property
    def selftest_file(self) -> str:
        """In one header the self-test holds the implementation, and so is C++."""
        return f"{self.selftest}.{'cpp' if self.single_header else 'c'}"

    @property
    def speeds(self) -> tuple[int, ...]:
        """Which numbers of the bodies are speeds."""
        before = len(self.impact.columns.parameters)
        return tuple(column - before for column in self.impact.columns.speeds)

    @property
    def varied_text(self) -> str:
        if self.scene.makes_varied:
            return f"`{self.varied}` must be empty: the kernel makes it"
        return f"`{self.varied}` may be empty: then the parameters decide"

    @property
    def goal_text(self) -> str:
        goal = self.request.goal
        if goal.budget is None:
            return f"by {goal.steps} fixed steps"
        return f"exact to {goal.budget:g} of {self.impact.relative_to}"

    @property
    def description(self) -> str:
        model, scene = self.request.model, self.scene.name
        return (
            f"Frictional collision of {self.impact.text}: contact model {model}, scene {scene}, "
            f"{self.goal_text}."
        )

    @property
    def method(self) -> str:
        """How the golden answers were found."""
        if self.fixed_step:
            return (
                f"Answers of the fixed-step scheme with N = {self.request.goal.steps} in long "
                "double, written apart from the kernels; cases that rounding could flip by a step "
                "are left out."
            )
        return (
            "Answers of an exact solver in long double (Taylor series of high order in the full "
            "velocities), written apart from the kernels; good to about 1e-15."
        )


def part_of(request: VendorRequest, rows: tuple[GoldenRow, ...], dispatched: bool) -> PartContext:
    """The part of a request for one impact."""
    return PartContext(request.row, request.known_scene, request.prefix, request, rows, dispatched)
