"""Ordered C++ statements: a target, an expression, and how it is stored."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import sympy as sp

from .counts import OperationCounts
from .printer import ExpressionPrinter


@dataclass(frozen=True)
class Assign:
    """`target = value;`, or `type target = value;` where it declares its target."""

    target: str
    value: sp.Expr | str
    declares: str = ""  # C++ type to declare with, empty for an assignment
    comment: str = ""


@dataclass
class Block:
    """Printed lines of straight-line code, and the operations that they take."""

    lines: list[str] = field(default_factory=list)
    counts: OperationCounts = field(default_factory=OperationCounts)

    def extend(self, other: Block) -> None:
        self.lines.extend(other.lines)
        self.counts = self.counts + other.counts


def lower(assignments: list[Assign], printer: ExpressionPrinter) -> Block:
    """Print assignments in the order given; text values are taken as they are (not counted)."""
    block = Block()
    for assignment in assignments:
        if isinstance(assignment.value, str):
            text, counts = assignment.value, OperationCounts()
        else:
            text, counts = printer.print_counted(assignment.value)
        head = f"{assignment.declares} " if assignment.declares else ""
        note = f"  // {assignment.comment}" if assignment.comment else ""
        block.lines.append(f"{head}{printer.name_of(assignment.target)} = {text};{note}")
        block.counts = block.counts + counts
    return block


@dataclass(frozen=True)
class Part:
    """Printed statements of one part and the operations that they take."""

    lines: tuple[str, ...]
    counts: OperationCounts

    def __iter__(self) -> Iterator[str]:
        return iter(self.lines)
