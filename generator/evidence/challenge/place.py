"""What a search asks of an impact: `SEARCH` of its module `search`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np

from ...errors import InputError
from ...impacts.impact import Impact
from ...impacts.registry import IMPACTS
from ..verification.errors import Array

Extent = Literal["real", "scene"]
Image = tuple[Array, Callable[[Array], Array]]  # cases, and what takes their velocities back


def quarter_turn(vectors: Array) -> Array:
    """Rows of vectors of three, each turned by a right angle about z."""
    table = vectors.reshape(len(vectors), -1, 3)
    return np.stack([-table[..., 1], table[..., 0], table[..., 2]], axis=-1).reshape(vectors.shape)


def turned_back(vectors: Array) -> Array:
    """What `quarter_turn` was given."""
    return quarter_turn(quarter_turn(quarter_turn(vectors)))


class Within(Protocol):
    """Where a search looks: the ranges of a scene, or of real use."""

    @property
    def scene(self) -> Any: ...
    @property
    def model(self) -> str: ...
    @property
    def extent(self) -> Extent: ...
    @property
    def ranges(self) -> Mapping[str, tuple[float, float]]:
        """What is varied, by name."""
        ...


@dataclass(frozen=True)
class Search:
    """How cases of an impact are made from numbers between 0 and 1, and what holds of them.

    A chart says what the numbers mean, each on a scale of its own: what is a spike in one chart is
    a wide hill in another. `cases_of` takes a table of numbers for each chart.
    """

    genes: int  # numbers that stand for a case
    envelope: Callable[[Any, str, Extent], Any]  # of a scene, a model and an extent
    draw_chart: Callable[[np.random.Generator, Any], Any]
    cases_of: Callable[[Sequence[Any], Sequence[Array], Any], list[Array]]
    parameters: tuple[int, ...]  # columns of a case that neighbours may differ in; only become less
    together: tuple[tuple[int, int], ...]  # of `parameters`, those that change alike
    images: Callable[[Any, Array], Iterator[Image]]  # cases that must come out alike
    energy: Callable[[Any, Array, Array], Array]  # kinetic, of cases that move with velocities
    gains_energy: Callable[[str], bool]  # does a contact model itself make energy grow?
    words: Callable[[Array], str]  # where a case lies, in short


def search_of(impact: Impact) -> Search:
    """InputError where nothing searches its cases yet."""
    if (search := found_search(impact)) is None:
        able = ", ".join(row.name for row in IMPACTS if found_search(row) is not None)
        raise InputError(f"--impact {impact.name}: no search of it yet; expected {able}")
    return search


def found_search(impact: Impact) -> Search | None:
    """None where nothing searches its cases yet."""
    try:
        search: Search = impact.part("search").SEARCH
    except ModuleNotFoundError as error:
        if error.name != f"{impact.package}.search":
            raise
        return None
    return search
