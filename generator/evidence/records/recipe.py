"""A recipe as text: how a kernel answers its question, without the question.

    RECIPE := STEPPER " x" WIDTH ( " " AXIS "=" CODE )*

Options at their default are left out, so a new axis leaves the text of what was there as it is.
"""

from __future__ import annotations

import re

from ...registry.axes import axis
from ...registry.variant import Stepper, Variant, budget_of, make_variant

_EXPLICIT = "lane_root"  # without one, lanes take that of single calls


def recipe_of(variant: Variant) -> str:
    """The recipe of a variant; `variant_of_recipe` reads it back."""
    words = [variant.stepper.name, f"x{variant.width}"]
    words += [
        f"{key}={code}"
        for key, code in variant.options
        if code != axis(key).default or key == _EXPLICIT
    ]
    return " ".join(words)


def contest_of(variant: Variant, batch: bool) -> str:
    """Kernels of one contest answer the same question, by the same function of the ABI."""
    head = (variant.target, variant.scene, variant.model, variant.stepper.goal)
    return "/".join((*head, "batch" if batch else "scalar"))


def variant_of_recipe(contest: str, recipe: str) -> Variant:
    """The variant in today's registry. Raises ValueError where one of the two does not read."""
    try:
        target, scene, model, goal, _call = contest.split("/")
        name, width, *pairs = recipe.split(" ")
        options = dict(pair.split("=") for pair in pairs)
    except ValueError:
        raise ValueError(f"'{contest}', '{recipe}': no contest and recipe") from None
    if not re.fullmatch(r"x[1-9][0-9]*", width):
        raise ValueError(f"'{width}' in '{recipe}' is no width; expected x1, x4, ...")
    fixed = goal.startswith("n")
    stepper = Stepper(
        name, steps=int(goal[1:]) if fixed else None, budget=None if fixed else budget_of(goal)
    )
    return make_variant(target, scene, model, stepper, int(width[1:]), **options)
