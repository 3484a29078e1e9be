"""A variant: a question and a recipe: all that decides the text of a kernel and its compiling."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from .axes import Axis, axes_of, axis
from .question import DEFAULT_IMPACT, Family, Goal, Question, Width
from .recipe import FIXED, Recipe, family_of

NUMBERS = "numbers"  # the axis that the question's width says


@dataclass(frozen=True)
class Stepper:
    """How the impulse is stepped: N fixed steps, or an exact scheme with an error budget."""

    name: str  # FIXED, or a tableau
    steps: int | None = None
    budget: float | None = None

    @property
    def family(self) -> Family:
        return family_of(self.name)

    @property
    def goal(self) -> Goal:
        return Goal(self.steps, self.budget)


def fixed_steps(steps: int | None) -> Stepper:
    """The stepper of that many fixed steps."""
    return Stepper(FIXED, steps=steps)


@dataclass(frozen=True)
class Variant:
    """One kernel, named by its question and its recipe."""

    question: Question
    recipe: Recipe

    @property
    def target(self) -> str:
        return self.question.target

    @property
    def scene(self) -> str:
        return self.question.scene

    @property
    def model(self) -> str:
        return self.question.model

    @property
    def width(self) -> int:
        """Lanes; 1 is scalar."""
        return self.question.width.lanes

    @cached_property
    def stepper(self) -> Stepper:
        goal = self.question.goal
        return Stepper(self.recipe.stepper, goal.steps, goal.budget)

    @cached_property
    def axes(self) -> tuple[Axis, ...]:
        """The options that such kernels have."""
        return _axes_of(self.question, self.recipe.stepper)

    @cached_property
    def options(self) -> tuple[tuple[str, str], ...]:
        """A choice for each axis, in axis order; of numbers in lanes, too."""
        return tuple((a.key, self._codes[a.key]) for a in self.axes)

    @cached_property
    def _codes(self) -> dict[str, str]:
        codes = dict(self.recipe.options)
        if any(a.key == NUMBERS for a in self.axes):
            codes[NUMBERS] = "float" if self.question.width.floats else axis(NUMBERS).default
        return codes

    def __getitem__(self, key: str) -> str:
        return self._codes[key]

    def get(self, key: str, otherwise: str = "") -> str:
        return self._codes.get(key, otherwise)

    def with_options(self, **changes: str) -> Variant:
        """The same kernel with other choices; ValueError names a choice that does not exist."""
        changed = {key: _checked(key, code) for key, code in changes.items()}
        return variant_with(self.question, self.recipe.stepper, {**self._codes, **changed})

    def with_stepper(self, stepper: Stepper) -> Variant:
        """The same options with another stepper of the family, or for another goal."""
        question = replace(self.question, goal=stepper.goal)
        return Variant(question, replace(self.recipe, stepper=stepper.name))

    def moved(
        self, *, target: str | None = None, scene: str | None = None, model: str | None = None
    ) -> Variant:
        """The same options for another target, scene or model."""
        asked = self.question
        other = replace(
            asked,
            target=asked.target if target is None else target,
            scene=scene or asked.scene,
            model=model or asked.model,
        )
        return Variant(other, self.recipe)

    def in_lanes(self, width: int, **changes: str) -> Variant:
        """The same kernel with batches in vectors of `width`; options of lanes default or given.

        With width 1 batches go one by one. ValueError names a choice that does not exist.
        """
        options = {key: code for key, code in self.options if not axis(key).lanes}
        question = replace(self.question, width=Width(width))
        return answered(question, self.recipe.stepper, {**options, **changes})

    @property
    def vectors(self) -> int:
        """Vectors that every operation of a batch is made for in turn."""
        code = self.get("interleave", "i1")
        return int(code[1:]) if code.startswith("i") else 1

    @property
    def paired(self) -> bool:
        """Are the stages of an exact step made for two vectors in turn?"""
        return self.get("interleave") == "s2"

    @property
    def rounds_as_written(self) -> bool:
        """Does its text decide how it rounds, and no compiler? Only such a kernel may be chosen."""
        return self.get("flags") == "strict" and self.get("fma") != "autofma"

    def distance_from_default(self) -> int:
        """How many options differ from the default; ties are broken by it."""
        return sum(code != axis(key).default for key, code in self.options)


def _axes_of(question: Question, stepper: str) -> tuple[Axis, ...]:
    return axes_of(family_of(stepper), question.width.lanes, question.row.axes)


def _checked(key: str, code: str) -> str:
    try:
        codes = axis(key).codes()
    except KeyError as error:
        raise ValueError(error.args[0]) from None
    if code not in codes:
        raise ValueError(f"option {key} has no value '{code}'; it has {', '.join(codes)}")
    return code


def variant_with(question: Question, stepper: str, codes: Mapping[str, str]) -> Variant:
    """A variant with a code for each axis that it has; others are left out."""
    axes = _axes_of(question, stepper)
    options = tuple((a.key, codes[a.key]) for a in axes if a.key != NUMBERS)
    if len(options) < len(axes):
        question = replace(question, width=Width(question.width.lanes, codes[NUMBERS] == "float"))
    return Variant(question, Recipe(stepper, options))


def answered(question: Question, stepper: str, options: Mapping[str, str]) -> Variant:
    """A question answered by a stepper, with defaults for every option that is not named.

    Lanes of an exact kernel make their roots as its single calls do, unless told otherwise. Options
    that only other kernels have are left out. ValueError names a choice that does not exist.
    """
    family = family_of(stepper)
    codes = {a.key: a.default for a in _axes_of(question, stepper)}
    if question.width.floats:
        codes[NUMBERS] = "float"
    if family == "exact" and "root" in options:
        codes["lane_root"] = options["root"]
    codes |= {key: _checked(key, code) for key, code in options.items()}
    return variant_with(question, stepper, codes)


def make_variant(
    target: str,
    scene: str,
    model: str,
    stepper: Stepper,
    width: int = 1,
    /,
    **options: str,
) -> Variant:
    """As `answered`, for a question of the default impact that is given in parts."""
    question = Question(DEFAULT_IMPACT, target, scene, model, stepper.goal, Width(width))
    return answered(question, stepper.name, options)
