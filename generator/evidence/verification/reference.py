"""Reference cases and what must come out of them, read from CSV."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...errors import InputError
from ...impacts.columns import Columns
from ...places import sources
from .case_table import read_table
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


def load_reference(files: ReferenceFiles) -> Reference:
    """Reads all files of a folder. Raises InputError naming the file and what is wrong."""
    columns = files.columns
    cases = read_table(files.folder / "inputs.csv", ("id", "kind", *columns.case))
    ids = cases.texts("id")

    def outcomes(name: str, more: Sequence[str] = ()) -> Array:
        answers = read_table(files.folder / name, ("id", *columns.velocities, *more))
        if answers.texts("id") != ids:
            raise InputError(
                f"{answers.path}: column id: expected the ids of inputs.csv, in its order"
            )
        status = np.zeros((len(ids), 1))  # every case of the reference collides
        return np.hstack([answers.numbers(columns.velocities), status, answers.numbers(more)])

    return Reference(
        ids=tuple(int(each) for each in cases.numbers(("id",))[:, 0]),
        kinds=cases.texts("kind"),
        cases=cases.numbers(columns.case),
        exact={model: outcomes(name, ("sticks",)) for model, name in files.exact.items()},
        published={key: outcomes(name) for key, name in files.published.items()},
    )
