"""The reference cases and what must come out of them, read from CSV."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np

from ...errors import InputError
from ...places import sources
from .errors import Array

FOLDER = sources() / "tests" / "data" / "reference"
MODELS = ("mathavan2014", "bottom_slip", "pooltool")
EULER_STEPS = 1000
_VECTORS = ("r", "v", "w")
CASE_NAMES = (
    *("R", "M", "u_s1", "u_s2", "u_b", "e_b"),
    *(f"{q}{ball}{axis}" for ball in "12" for q in _VECTORS for axis in "xyz"),
)
OUTCOME_NAMES = tuple(f"{q}{ball}{axis}" for ball in "12" for q in "vw" for axis in "xyz")


@dataclass(frozen=True)
class Reference:
    """Cases in rows of 24 and outcomes in the columns of `verification.errors`."""

    ids: tuple[int, ...]
    kinds: tuple[str, ...]
    cases: Array
    exact: Mapping[str, Array]  # model -> rows of 14
    euler_pooltool: Array  # rows of 13: pooltool's own function with 1000 steps, in double

    def rows_of(self, kind: str) -> Array:
        """Indices of the cases whose kind starts with `kind`, as `seed_case`."""
        return np.array([i for i, k in enumerate(self.kinds) if k.startswith(kind)], dtype=int)


def _records(path: Path) -> list[dict[str, str]]:
    try:
        with path.open(newline="", encoding="utf-8") as file:
            records = list(csv.DictReader(file))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    if not records:
        raise InputError(f"{path}: no rows; expected a header and at least one case")
    return records


def _table(path: Path, records: list[dict[str, str]], names: Sequence[str]) -> Array:
    missing = [name for name in names if name not in records[0]]
    if missing:
        raise InputError(f"{path}: no column {missing[0]}; expected {','.join(names)}")
    try:
        return np.array([[float(record[name]) for name in names] for record in records])
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: a value is no number: {error}") from None


def _outcomes(path: Path, ids: tuple[int, ...], more: Sequence[str]) -> Array:
    records = _records(path)
    table = _table(path, records, ("id", *OUTCOME_NAMES, *more))
    if tuple(int(i) for i in table[:, 0]) != ids:
        raise InputError(f"{path}: column id: expected the ids of inputs.csv, in its order")
    status = np.zeros((len(table), 1))  # every case of the reference collides
    velocities = table[:, 1 : 1 + len(OUTCOME_NAMES)]
    return np.hstack([velocities, status, table[:, 1 + len(OUTCOME_NAMES) :]])


def load_reference(folder: Path = FOLDER) -> Reference:
    """Reads all files of a folder. Raises InputError naming the file and what is wrong."""
    path = folder / "inputs.csv"
    records = _records(path)
    ids = tuple(int(i) for i in _table(path, records, ("id",))[:, 0])
    exact = {model: _outcomes(folder / f"exact_{model}.csv", ids, ("sticks",)) for model in MODELS}
    return Reference(
        ids=ids,
        kinds=tuple(record["kind"] for record in records),
        cases=_table(path, records, CASE_NAMES),
        exact=MappingProxyType(exact),
        euler_pooltool=_outcomes(folder / "euler_n1000.csv", ids, ()),
    )
