"""What verbs print: tables, JSON, progress, each in one way."""

from __future__ import annotations

import dataclasses
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from ..api.session import Session

Row = Mapping[str, object]
ANY_WIDTH = 100_000  # of a pipe


def rows_of(found: Sequence[Any]) -> list[dict[str, Any]]:
    """Dataclasses as rows; what they hold within stays as it is."""
    return [{f.name: getattr(each, f.name) for f in dataclasses.fields(each)} for each in found]


def show(tables: Mapping[str, Sequence[Row]], as_json: bool, err: bool = False) -> None:
    """Tables by title, or one JSON document: of all tables by title, of one alone its rows."""
    if as_json:
        only = next(iter(tables.values())) if len(tables) == 1 else tables
        click.echo(json.dumps(only, indent=1, default=_plain), err=err)
        return
    for number, (title, rows) in enumerate(tables.items()):
        click.echo(f"{chr(10) * bool(number)}{title}", err=err)
        _print(rows, err)


def _print(rows: Sequence[Row], err: bool) -> None:
    """Columns as the rows name them. On a terminal cells are folded, in a pipe a row is a line."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(stderr=err)
    if not console.is_terminal:
        console.width = ANY_WIDTH
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for key in rows[0] if rows else ():
        right = all(isinstance(row[key], int | float) for row in rows)
        table.add_column(
            key.replace("_", " "), overflow="fold", justify="right" if right else "left"
        )
    for row in rows:
        table.add_row(*(Text(cell(value)) for value in row.values()))
    console.print(table)


def cell(value: object) -> str:
    """A value for a reader: `-` where there is none."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, Mapping):
        return ", ".join(f"{key} = {cell(each)}" for key, each in value.items()) or "-"
    if isinstance(value, tuple | list):
        return ", ".join(cell(each) for each in value) or "-"
    return str(value)


def _plain(value: object) -> object:
    """What JSON has no word for."""
    return dict(value) if isinstance(value, Mapping) else str(value)


def three_digits(value: float) -> str:
    """A ratio with three significant digits, without an exponent: 0.0123, 1.23, 233, 12300."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:.0f}" if rounded >= 100 else f"{rounded:#.3g}"


class Bars:
    """A listener that shows steps as a bar on a terminal, and elsewhere a line for each kind."""

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
        from rich.progress import TimeElapsedColumn as Elapsed

        columns = TextColumn("{task.description}"), BarColumn(24), MofNCompleteColumn(), Elapsed()
        self.console = Console(stderr=True)
        self.bars = Progress(
            *columns, console=self.console, transient=True, disable=not self.console.is_terminal
        )
        self._task = self.bars.add_task("", total=None, visible=False)
        self._last = ""

    def step(self, what: str, done: int, of: int) -> None:
        head = what.split(" (")[0]
        if not self.console.is_terminal and head != self._last:
            self.note(what)
        self._last = head
        self.bars.update(self._task, description=what, completed=done, total=of, visible=True)

    def note(self, line: str) -> None:
        text = f"carom: {line}"
        self.console.print(text, highlight=False, markup=False, soft_wrap=True)


@contextmanager
def session() -> Iterator[Session]:
    """The session of a command, whose steps and notes show on standard error."""
    from ..api.session import Session

    base = click.get_current_context().find_object(Session) or Session()
    bars = Bars()
    with bars.bars:
        yield dataclasses.replace(base, listener=bars)


def command_line() -> str:
    """What the user typed, for records."""
    import shlex

    return " ".join(["./gen", *map(shlex.quote, sys.argv[1:])])
