"""Reading cases and writing outcomes as CSV, strictly."""

from __future__ import annotations

import csv
import io
import math
import textwrap
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..evidence.verification.errors import Array
from ..evidence.verification.reference import CASE_NAMES, OUTCOME_NAMES
from ..impacts.ball_ball.parameters import LIMITS

_OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars", " ": "blanks"}


@dataclass(frozen=True)
class CaseTable:
    """Rows of 24 in the columns of verification.errors, with the ids as they were written."""

    ids: tuple[str, ...]
    rows: Array


def _number(text: str | None, path: Path, line: int, name: str) -> float:
    plain = (text or "").replace("_", "x")  # Python alone reads 1_000 as a number
    try:
        value = float.fromhex(plain) if "0x" in plain.lower() else float(plain)
    except ValueError:
        shown = f"'{textwrap.shorten(text, 40)}'" if text else "nothing"
        raise InputError(
            f"{path}: row {line}, column {name}: {shown} is no number; write one as 0.05"
        ) from None
    if name in LIMITS and not math.isnan(value):
        low, high = LIMITS[name]
        if not low <= value <= high:
            raise InputError(
                f"{path}: row {line}, column {name}: {value:g} is out of range; "
                f"expected {low:g} to {high:g}"
            )
    return value


def _require_columns(header: list[str], path: Path) -> None:
    """Raise InputError where the first row does not name every column once."""
    wanted = ("id", *CASE_NAMES)
    if not any(header):
        raise InputError(
            f"{path}: row 1: is empty, no column id; expected id,{','.join(CASE_NAMES)}"
        )
    for mark, name in _OTHER_SEPARATORS.items():
        words = {word.strip(' "') for word in ",".join(header).split(mark)}
        if not words.isdisjoint(CASE_NAMES) and set(header).isdisjoint(CASE_NAMES):
            raise InputError(
                f"{path}: row 1: its columns are separated by {name}; expected commas, and a point "
                "in numbers, as 0.05"
            )
    missing = [name for name in wanted if name not in header]
    if missing:
        raise InputError(
            f"{path}: row 1: no column {missing[0]}; expected id,{','.join(CASE_NAMES)}"
        )
    twice = [name for name in wanted if header.count(name) > 1]
    if twice:
        raise InputError(f"{path}: row 1: column {twice[0]} twice; expected it once")


def read_cases(path: Path) -> CaseTable:
    """Cases by header name, extra columns ignored. InputError names file, row and column."""
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
        _require_columns(header, path)
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
            rows.append([_number(record[n], path, reader.line_num, n) for n in CASE_NAMES])
    except csv.Error as error:
        raise InputError(f"{path}: row {reader.line_num}: not CSV: {error}") from None
    if not rows:
        raise InputError(f"{path}: only a header; expected at least one row of a case")
    return CaseTable(tuple(ids), np.array(rows))


def outcome_text(ids: tuple[str, ...], outcomes: Array) -> str:
    """CSV of outcomes: id, v1x..w2z, status; numbers that read back to the same double."""
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["id", *OUTCOME_NAMES, "status"])
    for identity, row in zip(ids, outcomes, strict=True):
        writer.writerow([identity, *(repr(float(x)) for x in row[:12]), int(row[12])])
    return stream.getvalue()
