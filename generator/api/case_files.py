"""Reading cases and writing outcomes as CSV, strictly."""

from __future__ import annotations

import csv
import io
import math
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..evidence.verification.errors import Array
from ..impacts.impact import Impact
from ..registry.question import DEFAULT_IMPACT, find_impact

Limits = Mapping[str, tuple[float, float]]
_OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars", " ": "blanks"}


@dataclass(frozen=True)
class CaseTable:
    """Rows in the columns of an impact, with the ids as they were written."""

    ids: tuple[str, ...]
    rows: Array


def _number(text: str | None, place: str, name: str, limits: Limits) -> float:
    plain = (text or "").replace("_", "x")  # Python alone reads 1_000 as a number
    try:
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


def _known(impact: str) -> tuple[tuple[str, ...], Limits]:
    """The columns of a case, and the ranges of its parameters."""
    row: Impact = find_impact(impact)
    return row.columns.case, {p.name: (p.low, p.high) for p in row.parameters}


def _require_columns(header: list[str], path: Path, names: tuple[str, ...]) -> None:
    """Raise InputError where the first row does not name every column once."""
    wanted = ("id", *names)
    if not any(header):
        raise InputError(f"{path}: row 1: is empty, no column id; expected id,{','.join(names)}")
    for mark, name in _OTHER_SEPARATORS.items():
        words = {word.strip(' "') for word in ",".join(header).split(mark)}
        if not words.isdisjoint(names) and set(header).isdisjoint(names):
            raise InputError(
                f"{path}: row 1: its columns are separated by {name}; expected commas, and a point "
                "in numbers, as 0.05"
            )
    missing = [name for name in wanted if name not in header]
    if missing:
        raise InputError(f"{path}: row 1: no column {missing[0]}; expected id,{','.join(names)}")
    twice = [name for name in wanted if header.count(name) > 1]
    if twice:
        raise InputError(f"{path}: row 1: column {twice[0]} twice; expected it once")


def read_cases(path: Path, impact: str = DEFAULT_IMPACT) -> CaseTable:
    """Cases by header name, extra columns ignored. InputError names file, row and column."""
    columns, limits = _known(impact)
    try:
        text = path.read_text("utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file in UTF-8; expected CSV") from None
    reader = csv.DictReader(io.StringIO(text, newline=""), skipinitialspace=True)
    ids, rows = [], []
    try:
        header = [name.strip() for name in reader.fieldnames or []]
        _require_columns(header, path, columns)
        reader.fieldnames = header
        for record in reader:
            if None in record:
                raise InputError(
                    f"{path}: row {reader.line_num}: more values than the {len(header)} columns of "
                    "row 1; expected one a column, and a point in numbers, as 0.05"
                )
            if not any((value or "").strip() for value in record.values()):
                continue  # a blank line, or one of commas alone
            ids.append(record["id"])
            place = f"{path}: row {reader.line_num}"
            rows.append([_number(record[name], place, name, limits) for name in columns])
    except csv.Error as error:
        raise InputError(f"{path}: row {reader.line_num}: not CSV: {error}") from None
    if not rows:
        raise InputError(f"{path}: only a header; expected at least one row of a case")
    return CaseTable(tuple(ids), np.array(rows))


def outcome_text(ids: tuple[str, ...], outcomes: Array, impact: str = DEFAULT_IMPACT) -> str:
    """CSV of outcomes: id, velocities, status; numbers that read back to the same double."""
    columns = find_impact(impact).columns
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["id", *columns.velocities, "status"])
    for identity, row in zip(ids, outcomes, strict=True):
        velocities = (repr(float(x)) for x in row[: columns.status])
        writer.writerow([identity, *velocities, int(row[columns.status])])
    return stream.getvalue()
