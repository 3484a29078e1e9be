"""Cases that once were a kernel's worst, kept to the last bit; how steep the exact result is."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from ...errors import InputError
from ...places import sources
from .errors import Array, errors_of
from .floors import SPEEDS, nudged
from .reference import CASE_NAMES

FILE = sources() / "tests" / "data" / "hard_cases.csv"
NEIGHBOURS = 32  # of a case, itself the first


def load_hard(path: Path = FILE) -> tuple[tuple[str, ...], Array]:
    """Kinds and rows of 24; any model may meet them. InputError names the file and the reason."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            records = list(csv.DictReader(file))
        rows = [[float.fromhex(record[name]) for name in CASE_NAMES] for record in records]
        kinds = tuple(record["kind"] for record in records)
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: {error!r}; expected a kind and 24 hexadecimal floats") from None
    return kinds, np.array(rows)


def neighbours(cases: Array) -> Array:
    """NEIGHBOURS rows for each case: itself, then its speeds changed by a rounding."""
    return np.vstack([nudged(case, NEIGHBOURS, SPEEDS) for case in cases])


def moved_by(rows: Array, exact: Array) -> Array:
    """How far a rounding of its speeds moves the exact result of each case, relative.

    `rows`: neighbours of cases; `exact`: their results.
    """
    own = np.repeat(exact[::NEIGHBOURS], NEIGHBOURS, axis=0)
    moved: Array = errors_of(rows, exact, own).relative.reshape(-1, NEIGHBOURS).max(axis=1)
    return moved
