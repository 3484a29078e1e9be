"""Cases that once were a kernel's worst, kept to the last bit; how steep the exact result is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .case_table import read_table
from .errors import Array, Measure, nudged

NEIGHBOURS = 32  # of a case, itself the first


def load_hard(path: Path, names: Sequence[str]) -> tuple[tuple[str, ...], Array]:
    """Kinds and rows; any model may meet them. InputError names the file and the reason."""
    table = read_table(path, ("kind", *names), may_be_empty=True)
    return table.texts("kind"), table.numbers(names)


def neighbours(cases: Array, measure: Measure) -> Array:
    """NEIGHBOURS rows for each case: itself, then its speeds changed by a rounding."""
    made = [nudged(case, NEIGHBOURS, measure.moving) for case in cases]
    return np.vstack(made) if made else cases


def moved_by(rows: Array, exact: Array, measure: Measure) -> Array:
    """How far a rounding of its speeds moves the exact result of each case, relative.

    `rows`: neighbours of cases; `exact`: their results.
    """
    own = np.repeat(exact[::NEIGHBOURS], NEIGHBOURS, axis=0)
    errors = measure.errors_of(rows, exact, own).relative
    moved: Array = errors.reshape(-1, NEIGHBOURS).max(axis=1)
    return moved
