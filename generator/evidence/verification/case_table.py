"""The one reader of CSV files with cases or answers: strict, by the names of columns."""

from __future__ import annotations

import csv
import io
import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import InputError
from .errors import Array

Limits = Mapping[str, tuple[float, float]]
_NONE: Limits = {}
_OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars", " ": "blanks"}


@dataclass(frozen=True)
class Table:
    """Rows of texts by column, and the line of the file that each stands on."""

    path: Path
    rows: tuple[Mapping[str, str], ...]
    lines: tuple[int, ...]

    def texts(self, name: str) -> tuple[str, ...]:
        return tuple(row[name] for row in self.rows)

    def numbers(self, names: Sequence[str], limits: Limits = _NONE) -> Array:
        """Columns of numbers, decimal or hexadecimal. InputError names file, row and column."""
        rows = [
            [_number(row[name], f"{self.path}: row {line}", name, limits) for name in names]
            for row, line in zip(self.rows, self.lines, strict=True)
        ]
        return np.array(rows, dtype=np.float64).reshape(len(rows), len(names))


def read_table(path: Path, names: Sequence[str], may_be_empty: bool = False) -> Table:
    """The rows of a file that has these columns, a label first; others are ignored.

    Raises InputError that names the file, the row and what is wrong.
    """
    try:
        text = path.read_text("utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file in UTF-8; expected CSV") from None
    reader = csv.DictReader(io.StringIO(text, newline=""), skipinitialspace=True)
    rows, lines = [], []
    try:
        header = [name.strip() for name in reader.fieldnames or []]
        _require_columns(header, path, names)
        reader.fieldnames = header
        for record in reader:
            if None in record:
                raise InputError(
                    f"{path}: row {reader.line_num}: more values than the {len(header)} columns of "
                    "row 1; expected one a column, and a point in numbers, as 0.05"
                )
            if not any((value or "").strip() for value in record.values()):
                continue  # a blank line, or one of commas alone
            rows.append(record)
            lines.append(reader.line_num)
    except csv.Error as error:
        raise InputError(f"{path}: row {reader.line_num}: not CSV: {error}") from None
    if not rows and not may_be_empty:
        raise InputError(f"{path}: only a header; expected at least one row of a case")
    return Table(path, tuple(rows), tuple(lines))


def _number(text: str | None, place: str, name: str, limits: Limits) -> float:
    plain = text or ""
    try:
        if "_" in plain:
            raise ValueError("Python alone reads 1_000 as a number")
        value = float.fromhex(plain) if "0x" in plain.lower() else float(plain)
    except ValueError:
        shown = f"'{textwrap.shorten(text, 40)}'" if text else "nothing"
        raise InputError(
            f"{place}, column {name}: {shown} is no number; write one as 0.05"
        ) from None
    if name in limits and not math.isnan(value):
        low, high = limits[name]
        if not low <= value <= high:
            raise InputError(
                f"{place}, column {name}: {value:g} is out of range; expected {low:g} to {high:g}"
            )
    return value


def _require_columns(header: Sequence[str], path: Path, names: Sequence[str]) -> None:
    """Raise InputError where the first row does not name every column once."""
    expected = f"expected {','.join(names)}"
    if not any(header):
        raise InputError(f"{path}: row 1: is empty, no column {names[0]}; {expected}")
    for mark, name in _OTHER_SEPARATORS.items():
        words = {word.strip(' "') for word in ",".join(header).split(mark)}
        if not words.isdisjoint(names[1:]) and set(header).isdisjoint(names[1:]):
            raise InputError(
                f"{path}: row 1: its columns are separated by {name}; expected commas, and a point "
                "in numbers, as 0.05"
            )
    missing = [name for name in names if name not in header]
    if missing:
        raise InputError(f"{path}: row 1: no column {missing[0]}; {expected}")
    twice = [name for name in names if header.count(name) > 1]
    if twice:
        raise InputError(f"{path}: row 1: column {twice[0]} twice; expected it once")
