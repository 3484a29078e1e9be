"""One loop of a fixed-step kernel: what its template needs to lay it out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from .....lowering.counts import OperationCounts
from .....lowering.statements import Part
from .....registry.variant import Variant

EMPTY = Part((), OperationCounts())


def join(*parts: Part) -> Part:
    """The lines of all parts in turn."""
    total = sum((part.counts for part in parts), OperationCounts())
    return Part(tuple(line for part in parts for line in part), total)


def text(*lines: str) -> Part:
    """Lines without operations."""
    return Part(lines, OperationCounts())


@dataclass(frozen=True)
class Loop:
    """One function of the generated file: what the templates need to lay it out."""

    name: str
    text: str
    template: str
    variant: Variant
    c_z: str = "c_z"
    no_slip: str = ""
    at_rest: Mapping[int, str] = field(default_factory=dict)
    declarations: tuple[str, ...] = ()
    before_loop: Part = EMPTY
    top: Part = EMPTY
    d_x: Part = EMPTY
    d_z: Part = EMPTY
    root_in_branch: Mapping[int, Part] = field(default_factory=lambda: {1: EMPTY, 2: EMPTY})
    table: Mapping[int, Part] = field(default_factory=dict)
    lift: Mapping[int, Part] = field(default_factory=dict)
    impulses: Part = EMPTY  # before the update, where no branch makes them
    update: Part = EMPTY
    slips: Part = EMPTY  # made anew after it
    bottom: Part = EMPTY
    after_loop: Part = EMPTY
    steady: str = ""
    pressed: int = 0
    resumes: bool = False
    masked_lift: tuple[str, ...] = ()
    pairs: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    in_lanes: OperationCounts = field(default_factory=OperationCounts)  # of the template's own

    @property
    def physical(self) -> bool:
        return self.variant["reuse"] in ("keep", "recompute")

    @property
    def blocks(self) -> bool:
        return self.variant["store"] == "blocks"

    @property
    def twostage(self) -> bool:
        return self.variant["loop"] == "twostage"

    @property
    def region(self) -> str:
        """What llvm-mca's markers call the loop: only the usual loops are modelled."""
        return "aside" if self.resumes or self.name == "iterate_level" else "loop"

    @property
    def chosen(self) -> bool:
        return bool(self.steady)

    def likely(self, condition: str) -> str:
        if self.variant["branch"] == "likely":
            return f"__builtin_expect({condition}, 1)"
        return condition

    def unlikely(self, condition: str) -> str:
        if self.variant["branch"] in ("likely", "chosen"):
            return f"__builtin_expect({condition}, 0)"
        return condition

    def mask(self, value: str, condition: str) -> str:
        """`value` where the condition holds, else 0: by ?: or by bits."""
        if self.variant["branch"] == "bitmask":
            return f"masked({value}, {condition})"
        return f"{condition} ? {value} : 0.0"

    def counts(self) -> OperationCounts:
        """Operations of one iteration with slip and one pressed ball (work and loop test too)."""
        ball = self.pressed or 2
        parts = [self.top, self.d_x, self.d_z, self.impulses, self.update, self.slips, self.bottom]
        parts += [self.root_in_branch[ball]]
        parts += [part for key, part in self.table.items() if key == ball or self._masks]
        parts += [part for key, part in self.lift.items() if key == ball or self._masks]
        work = OperationCounts(add=2, mul=1, compare=2) + self.in_lanes
        return sum((part.counts for part in parts), work)

    @property
    def _masks(self) -> bool:
        return self.variant["branch"] in ("inverted", "bitmask")
