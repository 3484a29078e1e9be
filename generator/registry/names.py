"""Names of kernels: the question, and after a space the recipe.

`name_of` makes them and `variant_of` reads them back; there is no other grammar. A file is named by
its question alone (question.py); how a recipe is written stands in recipe.py.
"""

from __future__ import annotations

from pathlib import Path

from ..errors import InputError
from .axes import axes_of
from .question import Question, Width, read_question
from .recipe import HIDDEN, family_of, read_recipe
from .variant import NUMBERS, Variant, answered


def name_of(variant: Variant) -> str:
    """The name of a variant; `variant_of` reads it back."""
    return f"{variant.question} {variant.recipe}"


def source_name_of(variant: Variant) -> str:
    """The name without what only the compiler sees: it names the source text."""
    return f"{variant.question} {source_recipe_of(variant)}"


def source_recipe_of(variant: Variant) -> str:
    """The recipe without what only the compiler sees."""
    return variant.recipe.text(without=HIDDEN)


def variant_of(name: str) -> Variant:
    """Read a name back. Raises ValueError that says which word is wrong and what it may be."""
    question, _, recipe = name.strip().partition(" ")
    return variant_from(read_question(question), recipe)


def variant_from(question: Question, recipe: str) -> Variant:
    """A question with the text of a recipe. Raises ValueError as `variant_of` does."""
    stepper, options = read_recipe(recipe)
    family, width = family_of(stepper), question.width
    if family != question.goal.family:
        expected = "n<steps> as n1000" if family == "fixed" else "e<budget> as e1m06"
        raise ValueError(f"'{question.goal}' is no goal of {stepper}; expected {expected}")
    known = [a.key for a in axes_of(family, width.lanes, question.row.axes)]
    if width.floats and NUMBERS not in known:
        raise ValueError(f"'{width}' is no width of {stepper}; expected {Width(width.lanes)}")
    strange = [key for key in options if key not in known or key == NUMBERS]
    if strange:
        there = ", ".join(key for key in known if key != NUMBERS)
        raise ValueError(f"{stepper} {width} has no option '{strange[0]}'; it has {there}")
    return answered(question, stepper, options)


def question_named(text: str, native: str) -> Question:
    """The question that a user names, by itself or by its file. InputError says what is wrong.

    `native`: the target that this name stands for.
    """
    fields = text.split("/")
    if text.endswith(".cpp"):
        fields = list(Path(text.removesuffix(".cpp")).resolve().parts[-4:])
    if fields[1:2] == ["native"]:
        fields[1] = native
    text = "/".join(fields)
    try:
        return read_question(text)
    except ValueError as error:
        raise InputError(str(error)) from None


def variant_named(text: str) -> Variant:
    """The kernel that a user names, as tables show it or as `carom_kernel()` tells it.

    What only the compiler sees may be left out, and is the default then. InputError says what is
    wrong.
    """
    try:
        return variant_of(text)
    except ValueError as error:
        raise InputError(str(error)) from None
