"""What a section of the page is made of. templates/report/page.html.j2 says how it looks.

Numbers are named by where they stand in the page's data, and printed from there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

from .plots import Plot

Path = tuple[str | int, ...]  # keys and indices, from the top of the data
Data = Mapping[str, Any]
Format = Literal["ns", "cycles", "ratio", "times", "error", "count", "mean", "percent"]
Style = Literal["", "note", "soft"]


@dataclass(frozen=True)
class Number:
    format: Format
    path: Path


@dataclass(frozen=True)
class Code:
    """A name of a kernel or a command."""

    code: str


Piece = str | Number | Code
Cell = Sequence[Piece]


@dataclass(frozen=True)
class Paragraph:
    kind: ClassVar[str] = "paragraph"
    pieces: Cell
    style: Style = ""


@dataclass(frozen=True)
class Heading:
    kind: ClassVar[str] = "heading"
    pieces: Cell


@dataclass(frozen=True)
class Lines:
    kind: ClassVar[str] = "lines"
    lines: Sequence[str]


@dataclass(frozen=True)
class Table:
    """`numeric`: the columns that are aligned to the right. `groups`: above the head, and spans."""

    kind: ClassVar[str] = "table"
    head: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    numeric: frozenset[int] = frozenset()
    caption: str = ""
    groups: Sequence[tuple[str, int]] = ()


@dataclass(frozen=True)
class Plots:
    kind: ClassVar[str] = "plots"
    plots: Sequence[Plot]


@dataclass(frozen=True)
class Details:
    kind: ClassVar[str] = "details"
    summary: str
    blocks: Sequence[Block]


Block = Paragraph | Heading | Lines | Table | Plots | Details


@dataclass(frozen=True)
class Section:
    """A section: its part of the page's data, and how that is laid out.

    `missing`: by what it is called, what is not known, and why. A section that has no blocks is
    named in one line with the others of the same reason, which stands under its own id.
    """

    id: str
    nav: str
    title: str
    data: Data
    blocks: Sequence[Block]
    missing: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Column:
    """A column of a table of records: what each row's record gives, by the row's own path."""

    head: str
    cell: Callable[[Path, Data], Cell]
    numeric: bool = False


def text(head: str, key: str) -> Column:
    return Column(head, lambda _, row: [str(row[key])])


def code(head: str, key: str) -> Column:
    return Column(head, lambda _, row: [Code(str(row[key]))])


def number(head: str, kind: Format, *path: str | int) -> Column:
    """A number of each record; nothing where a record has no such entry."""

    def cell(at: Path, row: Data) -> Cell:
        value: Any = row
        for step in path:
            if isinstance(value, Mapping) and step not in value:
                return []
            value = value[step]
        return [Number(kind, at + path)]

    return Column(head, cell, numeric=True)


def ratio(head: str) -> Column:
    """The record's ratio with its interval."""
    return Column(head, lambda at, row: with_interval(at, row), numeric=True)


def with_interval(at: Path, row: Data) -> Cell:
    shown = Number("ratio", (*at, "ratio"))
    return [shown, " (", *interval((*at, "ratio_ci")), ")"] if row["ratio_ci"] else [shown]


def interval(at: Path) -> list[Piece]:
    return [Number("ratio", (*at, 0)), " to ", Number("ratio", (*at, 1))]


def records(at: Path, rows: Iterable[Data], columns: Sequence[Column], caption: str = "") -> Table:
    """A row for each record of a list that stands at `at` in the data."""
    cells = [[c.cell((*at, n), row) for c in columns] for n, row in enumerate(rows)]
    right = frozenset(n for n, column in enumerate(columns) if column.numeric)
    return Table([c.head for c in columns], cells, right, caption)
