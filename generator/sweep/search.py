"""Which variants to try next: known good ones, each option once, then what promises most."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from random import Random

import numpy as np
from numpy.typing import NDArray

from ..registry.names import name_of
from ..registry.variant import Variant
from .space import Space

LEADERS = 5  # the best so far, all of whose neighbours are tried
_RANDOM_SHARE = 6  # one in so many is drawn at random, against a search that sees only one valley
_ALIKE = 0.01  # ratios that the model cannot tell apart
_DOUBTFUL = 3  # variants with an option, all rejected: what else has it comes last
_RIDGE = 0.1


def features(variant: Variant) -> tuple[str, ...]:
    """What a variant is made of, for the model of times."""
    head = (f"stepper={variant.stepper.name}", f"width={variant.width}")
    return (*head, *(f"{key}={code}" for key, code in variant.options))


@dataclass(frozen=True)
class EffectModel:
    """log(ratio) as a sum over options: least squares, drawn a little towards no effect."""

    mean: float
    effects: Mapping[str, float]

    @staticmethod
    def fit(ratios: Sequence[tuple[Variant, float]]) -> EffectModel:
        logs = np.log([ratio for _, ratio in ratios])
        names = sorted({name for variant, _ in ratios for name in features(variant)})
        column = {name: index for index, name in enumerate(names)}
        design = np.zeros((len(ratios), len(names)))
        for row, (variant, _) in enumerate(ratios):
            design[row, [column[name] for name in features(variant)]] = 1.0
        mean = float(logs.mean())
        normal: NDArray[np.float64] = design.T @ design + _RIDGE * np.eye(len(names))
        solved = np.linalg.solve(normal, design.T @ (logs - mean))
        return EffectModel(mean, dict(zip(names, solved.tolist(), strict=True)))

    def ratio(self, variant: Variant) -> float:
        """The ratio that the model expects."""
        return math.exp(self.mean + sum(self.effects.get(name, 0.0) for name in features(variant)))


@dataclass
class Search:
    """Proposals for one contest, in waves. Each variant is proposed once.

    First the seeds, and the best of them with each option that none had; then waves out of what
    lies one option from the leaders and two from the best, in the order that the model of times
    gives, with some random ones among them. It ends where that neighbourhood has been tried.
    An exhaustive one takes all, in a random order: as much of it as was done is a fair sample.
    """

    space: Space
    seeds: Iterable[Variant]
    random: Random
    exhaustive: bool = False
    proposed: set[str] = field(default_factory=set)
    _tried: set[tuple[str, str]] = field(default_factory=set)  # options

    def __post_init__(self) -> None:
        seeds = (variant for variant in self.seeds if self.space.has(variant))
        self._first_ones = self._everything() if self.exhaustive else seeds

    def next_wave(
        self,
        size: int,
        ratios: Sequence[tuple[Variant, float]],
        rejected: Sequence[Variant] = (),
    ) -> list[Variant]:
        """Up to `size` variants; none where all is done. `ratios`: what was timed, best first."""
        wave = self._new(self._first_ones, size)
        if not self.exhaustive:
            best = ratios[0][0] if ratios else None
            wave += self._new(self._untried(best), size - len(wave))
        if self.exhaustive or not ratios or len(wave) == size:
            return wave
        return wave + self._promising(size - len(wave), ratios, rejected)

    def _everything(self) -> Iterator[Variant]:
        found = list(self.space.everything())
        self.random.shuffle(found)
        yield from found

    def _untried(self, best: Variant | None) -> Iterator[Variant]:
        """Each option that no variant had yet: in the best where that is legal, else at random."""
        options = {
            (axis.key, code): None
            for width in self.space.widths
            for axis, codes in self.space.axes(width)
            for code in codes
        }
        for key, code in options:
            if (key, code) in self._tried:
                continue
            near = best.with_options(**{key: code}) if best else None
            if near is None or not self.space.has(near):
                near = self.space.drawn(self.random, **{key: code})
            if near is not None:
                yield near

    def _new(self, variants: Iterator[Variant], count: int) -> list[Variant]:
        """Up to so many that were not proposed before; no more are taken than that needs."""
        found: list[Variant] = []
        while len(found) < count and (variant := next(variants, None)) is not None:
            name = name_of(variant)
            if name not in self.proposed:
                found.append(variant)
                self.proposed.add(name)
                self._tried.update(variant.options)
        return found

    def _promising(
        self, size: int, ratios: Sequence[tuple[Variant, float]], rejected: Sequence[Variant]
    ) -> list[Variant]:
        near = self._near([variant for variant, _ in ratios[:LEADERS]])
        if not near:
            return []
        model, doubtful = EffectModel.fit(ratios), _doubtful(ratios, rejected)

        def promise(item: tuple[str, Variant]) -> tuple[bool, int, int, str]:
            """Of those alike, the one that would be chosen: with the fewest options changed."""
            name, variant = item
            known = doubtful.isdisjoint(features(variant))
            alike = round(math.log(model.ratio(variant)) / _ALIKE)
            return not known, alike, variant.distance_from_default(), name

        ranked = sorted(near.items(), key=promise)
        chosen = dict(ranked[: size - size // _RANDOM_SHARE])
        for _ in range(size - len(chosen)):
            drawn = self.space.drawn(self.random)
            if drawn is not None and name_of(drawn) not in self.proposed:
                chosen.setdefault(name_of(drawn), drawn)
        self.proposed.update(chosen)
        return list(chosen.values())

    def _near(self, leaders: Sequence[Variant]) -> dict[str, Variant]:
        """What was not proposed yet of all one option from the leaders, and two from the best."""
        first = self.space.neighbours(leaders[0])
        second = [far for one in first for far in self.space.neighbours(one)]
        others = [one for leader in leaders[1:] for one in self.space.neighbours(leader)]
        found = {name_of(variant): variant for variant in (*first, *others, *second)}
        return {name: v for name, v in found.items() if name not in self.proposed}


def _doubtful(ratios: Sequence[tuple[Variant, float]], rejected: Sequence[Variant]) -> set[str]:
    """Options that no variant with them has passed with, of which the model knows nothing."""
    passed = {name for variant, _ in ratios for name in features(variant)}
    failed = Counter(name for variant in rejected for name in features(variant))
    return {name for name, n in failed.items() if n >= _DOUBTFUL and name not in passed}
