"""Reference cases and what must come out of them, read from CSV."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...errors import InputError
from ...impacts.columns import Columns
from ...places import sources
from .errors import Array

DATA = sources() / "tests" / "data"


@dataclass(frozen=True)
class ReferenceFiles:
    """The files of an impact: `inputs.csv` with the cases, and answers to them."""

    folder: Path
    columns: Columns
    exact: Mapping[str, str] = field(default_factory=dict)  # by contact model
    # Another program's own answers by fixed steps, in double: by model and number of steps.
    published: Mapping[tuple[str, int], str] = field(default_factory=dict)


@dataclass(frozen=True)
class Reference:
    """Cases and outcomes in rows, in the columns of an impact."""

    ids: tuple[int, ...]
    kinds: tuple[str, ...]
    cases: Array
    exact: Mapping[str, Array]  # model -> outcomes, and whether contact sticks
    published: Mapping[tuple[str, int], Array]  # model and steps -> outcomes

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


def load_reference(files: ReferenceFiles) -> Reference:
    """Reads all files of a folder. Raises InputError naming the file and what is wrong."""
    path = files.folder / "inputs.csv"
    records = _records(path)
    ids = tuple(int(i) for i in _table(path, records, ("id",))[:, 0])

    def outcomes(name: str, more: Sequence[str] = ()) -> Array:
        place, names = files.folder / name, files.columns.velocities
        answers = _records(place)
        table = _table(place, answers, ("id", *names, *more))
        if tuple(int(i) for i in table[:, 0]) != ids:
            raise InputError(f"{place}: column id: expected the ids of inputs.csv, in its order")
        status = np.zeros((len(table), 1))  # every case of the reference collides
        return np.hstack([table[:, 1 : 1 + len(names)], status, table[:, 1 + len(names) :]])

    return Reference(
        ids=ids,
        kinds=tuple(record["kind"] for record in records),
        cases=_table(path, records, files.columns.case),
        exact={model: outcomes(name, ("sticks",)) for model, name in files.exact.items()},
        published={key: outcomes(name) for key, name in files.published.items()},
    )
