"""Evolution strategies side by side, whose generations are judged in one batch.

Each island has a chart of its own and starts from the best of a random generation. One that has
come to rest leaves its best case and makes room for the next: on another chart, or on the chart of
one of the best so far, close to where that was found.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import cma
import numpy as np

from ..verification.errors import Array
from .place import Search, Within

_POPULATION = 24
_FIRST = 96  # of them at random
_WIDTH, _NARROW = 0.12, 0.02  # of the first generation on another chart, and close to a good one
_REST = 8  # generations without a gain of a fiftieth
_MOST = 120  # generations
_AGAIN = 0.3  # share of islands that begin close to a good one
_KEPT = 12  # good ones
_MUTANTS = 192  # of a parent, a round: running back costs the less a case, the more there are
Chart = Any  # of the impact that is searched
Score = Callable[[Array], Array]  # cases -> what is to be as large as possible


@dataclass
class Island:
    """A strategy and the best that it has found."""

    chart: Chart
    seed: int
    width: int  # how many numbers stand for a case
    near: Array | None = None  # genes to begin with, else a random generation
    best: float = -np.inf
    genes: Array = field(init=False)
    case: Array | None = None
    generations: int = 0
    since: int = 0  # generations since the last gain
    strategy: cma.CMAEvolutionStrategy | None = None

    def __post_init__(self) -> None:
        self.genes = np.full(self.width, 0.5)

    def ask(self) -> Array:
        if self.strategy is None and self.near is None:
            return np.random.default_rng(self.seed).uniform(0, 1, (_FIRST, self.width))
        strategy = self.strategy
        if strategy is None:
            strategy = self._begin(self.near, _NARROW)
        return np.array(strategy.ask())

    def tell(self, genes: Array, cases: Array, scores: Array) -> None:
        top = int(np.argmax(scores))
        self.generations += 1
        self.since += 1
        if scores[top] > self.best:
            self.since = 0 if scores[top] > 1.02 * self.best else self.since
            self.best, self.genes, self.case = float(scores[top]), genes[top], cases[top].copy()
        if self.strategy is None:
            self._begin(self.genes, _WIDTH)
            return
        finite = np.where(np.isfinite(scores), -scores, np.where(scores > 0, -1e30, 1e30))
        self.strategy.tell(list(genes), finite.tolist())

    def take(self, score: float, genes: Array, case: Array) -> None:
        """What was found elsewhere, better than its own: it goes on from there."""
        self.since = 0 if score > 1.02 * self.best else self.since
        self.best, self.genes, self.case = score, genes, case
        if self.strategy is not None:
            self.strategy.inject([genes])

    def _begin(self, genes: Array | None, width: float) -> cma.CMAEvolutionStrategy:
        draw = np.random.default_rng(self.seed).standard_normal  # not NumPy's, which threads share
        options = {
            "popsize": _POPULATION,
            "verbose": -9,
            "seed": np.nan,
            "randn": lambda *shape: draw(shape),
        }
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.strategy = cma.CMAEvolutionStrategy(genes, width, options)
        return self.strategy

    @property
    def resting(self) -> bool:
        if self.since >= _REST or self.generations >= _MOST or self.best == np.inf:
            return True
        return self.strategy is not None and bool(self.strategy.stop())


@dataclass(frozen=True)
class Found:
    """The best that an island has left."""

    score: float
    chart: Chart
    genes: Array
    case: Array


@dataclass
class Archipelago:
    """`size` islands at a time, one generation of each in every round, and beside them mutants.

    A mutant is one of the best with some of its numbers changed, by anything from a tenth to a
    millionth: what a spike in a plain needs, where a strategy sees the plain alone.
    """

    space: Search
    within: Within
    seed: int
    size: int
    found: list[Found] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(self.seed)
        self._islands = [self._new() for _ in range(self.size)]

    def round(self, score: Score) -> None:
        """One generation of every island and of mutants, judged together."""
        parents = self._parents()
        charts = [*(i.chart for i in self._islands), *(p.chart for p in parents)]
        asked = [*(i.ask() for i in self._islands), *(self._mutants(p) for p in parents)]
        made = self.space.cases_of(charts, asked, self.within)
        cases = np.concatenate(made)
        sound = np.isfinite(cases).all(axis=1)
        scores = np.full(len(cases), -np.inf)
        scores[sound] = score(cases[sound])
        split = np.split(scores, np.cumsum([len(rows) for rows in made])[:-1])
        told = list(zip(asked, made, split, strict=True))
        for island, generation in zip(self._islands, told, strict=False):
            island.tell(*generation)
        for parent, generation in zip(parents, told[self.size :], strict=True):
            self._replace(parent, *generation)
        self._islands = [self._renewed(island) for island in self._islands]

    @property
    def best(self) -> float:
        left = self.found[0].score if self.found else -np.inf
        return max(left, *(island.best for island in self._islands))

    def finish(self) -> list[Found]:
        """All that was found, best first, what the islands have now included."""
        for island in self._islands:
            self._leave(island)
        return self.found

    def _good(self) -> list[Found]:
        """The best left behind. Not what is refused: there is nothing larger to be found there."""
        return [f for f in self.found if np.isfinite(f.score)][:_KEPT]

    def _parents(self) -> list[Found]:
        here = [
            Found(island.best, island.chart, island.genes, island.case)
            for island in self._islands
            if island.case is not None and np.isfinite(island.best)
        ]
        return sorted([*self._good(), *here], key=lambda f: -f.score)[: self.size]

    def _mutants(self, parent: Found) -> Array:
        shape = (_MUTANTS, self.space.genes)
        sizes = 10 ** self._rng.uniform(-6, -0.7, (_MUTANTS, 1))
        steps = self._rng.normal(size=shape) * (self._rng.random(shape) < 0.5)
        return parent.genes + sizes * steps

    def _replace(self, parent: Found, genes: Array, cases: Array, scores: Array) -> None:
        """The best mutant takes its parent's place if it is better."""
        top = int(np.argmax(scores))
        if not scores[top] > parent.score:
            return
        better = Found(float(scores[top]), parent.chart, genes[top], cases[top].copy())
        for island in self._islands:
            if island.genes is parent.genes:
                island.take(better.score, better.genes, better.case)
                return
        self.found = [better if f is parent else f for f in self.found]
        self.found.sort(key=lambda f: -f.score)

    def _renewed(self, island: Island) -> Island:
        if not island.resting:
            return island
        self._leave(island)
        return self._new()

    def _leave(self, island: Island) -> None:
        if island.case is not None:
            self.found.append(Found(island.best, island.chart, island.genes, island.case))
            self.found.sort(key=lambda f: -f.score)

    def _new(self) -> Island:
        seed = int(self._rng.integers(1, 2**31))
        good = self._good()
        if good and self._rng.random() < _AGAIN:
            start = good[int(self._rng.integers(len(good)))]
            return Island(start.chart, seed, self.space.genes, near=start.genes)
        chart = self.space.draw_chart(self._rng, self.within)
        return Island(chart, seed, self.space.genes)
