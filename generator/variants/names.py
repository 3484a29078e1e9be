"""The one grammar of kernel names.

    NAME := TARGET "." SCENE "." MODEL "." STEPPER "." GOAL "." WIDTH ( "." CHOICE )*

TARGET, SCENE, MODEL and STEPPER are registry names (letters, digits, `-` and `_`); GOAL is
`n<steps>` or `e<budget>`; WIDTH is `x<lanes>`; then one CHOICE code for each axis of the stepper's
family and width, in axis order. Files use the name as it is, C symbols with `.` and `-` turned
into `_`.
"""

from __future__ import annotations

import re

from generator.variants.axes import axes_of
from generator.variants.variant import Stepper, Variant, budget_of, make_variant

_FIELD = re.compile(r"[A-Za-z0-9_-]+")


def name_of(variant: Variant) -> str:
    """The name of a variant; `variant_of` reads it back."""
    head = (
        variant.target,
        variant.scene,
        variant.model,
        variant.stepper.name,
        variant.stepper.goal,
        f"x{variant.width}",
    )
    return ".".join((*head, *(code for _, code in variant.options)))


def source_name_of(variant: Variant) -> str:
    """The name without the fields that only the compiler sees: it names the source text."""
    hidden = {"compiler", "flags"}
    head = name_of(variant).split(".")[:6]
    return ".".join((*head, *(code for key, code in variant.options if key not in hidden)))


def symbol_of(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9]", "_", name)


def variant_of(name: str) -> Variant:
    """Read a name back. Raises ValueError that says which field is wrong and what it may be."""
    fields = name.split(".")
    if len(fields) < 6 or not all(_FIELD.fullmatch(field) for field in fields):
        raise ValueError(
            f"'{name}' is no kernel name; expected TARGET.SCENE.MODEL.STEPPER.GOAL.xWIDTH.CHOICES"
        )
    target, scene, model, stepper_name, goal, width = fields[:6]
    stepper = _stepper_of(stepper_name, goal)
    if not re.fullmatch(r"x[1-9][0-9]*", width):
        raise ValueError(f"'{width}' in '{name}' is no width; expected x1, x4, ...")
    axes = axes_of(stepper.family, int(width[1:]))
    if len(fields) - 6 != len(axes):
        raise ValueError(
            f"'{name}' has {len(fields) - 6} choices; {stepper.name} {width} has {len(axes)}: "
            f"{'.'.join(a.key for a in axes)}"
        )
    options = {a.key: code for a, code in zip(axes, fields[6:], strict=True)}
    return make_variant(target, scene, model, stepper, int(width[1:]), **options)


def _stepper_of(name: str, goal: str) -> Stepper:
    if re.fullmatch(r"n[1-9][0-9]*", goal):
        return Stepper(name, steps=int(goal[1:]))
    if re.fullmatch(r"e[0-9](p[0-9]+)?m[0-9]+", goal):
        return Stepper(name, budget=budget_of(goal))
    raise ValueError(f"'{goal}' is no goal; expected n<steps> as n1000, or e<budget> as e1m06")
