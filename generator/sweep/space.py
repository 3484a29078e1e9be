"""What a sweep may try: every legal variant of a contest, one step from another, or drawn."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from random import Random

from ..choice.seeds import steppers_of
from ..errors import InputError
from ..registry.axes import AXES, Axis, axes_of
from ..registry.question import Contest, Question, Width
from ..registry.rules import Rule, broken_rule
from ..registry.variant import Stepper, Variant, answered, variant_with
from ..targets.target import Target

_FEW = 3000  # combinations that are all looked at before one is drawn
_DRAWS = 20_000  # about a tenth of all combinations are legal


@dataclass(frozen=True)
class Space:
    """The legal variants of a contest, as the registry has them now.

    `only`: codes that an axis may have, for axes that are not free. `compilers`: codes of those
    that are here. A new axis or code of the registry is in it without a change here.
    """

    contest: Contest
    target: Target
    compilers: tuple[str, ...]
    widths: tuple[int, ...]
    only: Mapping[str, tuple[str, ...]]

    @property
    def steppers(self) -> tuple[Stepper, ...]:
        """Those that reach the contest's goal."""
        return steppers_of(self.contest)

    def axes(self, width: int) -> tuple[tuple[Axis, tuple[str, ...]], ...]:
        """The axes that kernels of a width have, each with the codes that it may have here."""
        found = []
        for axis in axes_of(self.contest.goal.family, width, self.contest.row.axes):
            codes = self.only.get(axis.key, axis.codes())
            if axis.key == "compiler":
                codes = tuple(code for code in codes if code in self.compilers)
            found.append((axis, codes))
        return tuple(found)

    def broken(self, variant: Variant) -> Rule | None:
        """The rule that a variant breaks on the target."""
        return broken_rule(variant, self.target)

    def has(self, variant: Variant) -> bool:
        """Is it one of this space: legal, and within `only`?"""
        if variant.width not in self.widths or variant.stepper not in self.steppers:
            return False
        within = all(variant[axis.key] in codes for axis, codes in self.axes(variant.width))
        return within and self.broken(variant) is None

    def everything(self) -> Iterator[Variant]:
        """All legal variants, in the order of the registry."""
        for stepper, width in itertools.product(self.steppers, self.widths):
            axes = self.axes(width)
            keys = [axis.key for axis, _ in axes]
            for codes in itertools.product(*(codes for _, codes in axes)):
                options = tuple(zip(keys, codes, strict=True))
                variant = self._variant(stepper, width, options)
                if self.broken(variant) is None:
                    yield variant

    def steps_from(self, variant: Variant) -> Iterator[Variant]:
        """All that differ from a variant in one option, stepper or width; legal or not."""
        for stepper in self.steppers:
            if stepper != variant.stepper:
                yield variant.with_stepper(stepper)
        for width in self.widths:
            if width != variant.width:
                yield from self._in_width(variant, width)
        for axis, codes in self.axes(variant.width):
            for code in codes:
                if code != variant[axis.key]:
                    yield variant.with_options(**{axis.key: code})

    def _in_width(self, variant: Variant, width: int) -> Iterator[Variant]:
        """In another number of lanes, with each kind of number that these may hold."""
        moved, codes = in_width(variant, width), {a.key: c for a, c in self.axes(width)}
        if "numbers" not in codes:
            yield moved
            return
        for code in codes["numbers"]:
            yield moved.with_options(numbers=code)

    def neighbours(self, variant: Variant) -> list[Variant]:
        """Those of `steps_from` that are legal."""
        return [other for other in self.steps_from(variant) if self.broken(other) is None]

    def drawn(self, random: Random, **fixed: str) -> Variant | None:
        """A legal variant at random, with some options as given; None where none was found."""
        if not all(codes for width in self.widths for _, codes in self.axes(width)):
            return None
        if self._combinations() <= _FEW:
            legal = [v for v in self.everything() if fixed.items() <= dict(v.options).items()]
            return random.choice(legal) if legal else None
        for _ in range(_DRAWS):
            stepper, width = random.choice(self.steppers), random.choice(self.widths)
            options = tuple(
                (axis.key, fixed.get(axis.key) or random.choice(codes))
                for axis, codes in self.axes(width)
            )
            variant = self._variant(stepper, width, options)
            if self.broken(variant) is None:
                return variant
        return None

    def _combinations(self) -> int:
        """Legal ones and others."""
        of_widths = sum(math.prod(len(c) for _, c in self.axes(width)) for width in self.widths)
        return len(self.steppers) * of_widths

    def _variant(
        self, stepper: Stepper, width: int, options: tuple[tuple[str, str], ...]
    ) -> Variant:
        c = self.contest
        asked = Question(c.impact, c.target, c.scene, c.model, c.goal, Width(width))
        return variant_with(asked, stepper.name, dict(options))


def in_width(variant: Variant, width: int) -> Variant:
    """The same options in another number of lanes; those that only one of them has: default."""
    question = replace(variant.question, width=Width(width))
    return answered(question, variant.recipe.stepper, dict(variant.options))


def parse_only(words: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
    """`--only rsqrt=inv,ahead` as axis and codes. InputError names what does not exist."""
    known = {axis.key: axis.codes() for axis in AXES}
    found: dict[str, tuple[str, ...]] = {}
    for word in words:
        key, _, listed = word.partition("=")
        if key not in known:
            raise InputError(f"--only {word}: no axis '{key}'; there are {', '.join(known)}")
        codes = tuple(listed.split(","))
        strange = [code for code in codes if code not in known[key]]
        if strange:
            raise InputError(
                f"--only {word}: {key} has no '{strange[0]}'; it has {', '.join(known[key])}"
            )
        found[key] = codes
    return found
