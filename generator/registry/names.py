"""The one grammar of kernel names.

    NAME := TARGET "." SCENE "." MODEL "." STEPPER "." GOAL "." WIDTH ( "." CHOICE )*

TARGET, SCENE, MODEL and STEPPER are registry names (letters, digits, `-` and `_`); GOAL is
`n<steps>` or `e<budget>`; WIDTH is `x<lanes>`; then one CHOICE code for each axis of the stepper's
family and width, in axis order. Files use the name as it is, C symbols with `.` and `-` turned
into `_`.
"""

from __future__ import annotations

import re
from pathlib import Path

from ..errors import InputError
from ..tableaus.tableaus import TABLEAUS
from .axes import axes_of
from .variant import Stepper, Variant, budget_of, make_variant

HIDDEN = ("compiler", "flags")  # what only the compiler sees
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
    head = name_of(variant).split(".")[:6]
    return ".".join((*head, *(code for key, code in variant.options if key not in HIDDEN)))


def symbol_of(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9]", "_", name)


def variant_of(name: str) -> Variant:
    """Read a name back. Raises ValueError that says which field is wrong and what it may be."""
    return _read(name)


def variant_named(text: str) -> Variant:
    """The kernel that a user names: in full, or as its text and file do and `carom_kernel()` tells.

    What only the compiler sees may be left out, and is the default then. A file may be a path.
    Raises InputError that says which field is wrong.
    """
    name = Path(text).name.removesuffix(".cpp") if text.endswith(".cpp") else text
    try:
        return _read(name, HIDDEN)
    except ValueError as error:
        raise InputError(str(error)) from None


def _read(name: str, may_lack: tuple[str, ...] = ()) -> Variant:
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
    if len(fields) - 6 == len(axes) - len(may_lack):
        axes = tuple(axis for axis in axes if axis.key not in may_lack)
    if len(fields) - 6 != len(axes):
        raise ValueError(
            f"'{name}' has {len(fields) - 6} choices; {stepper.name} {width} has {len(axes)}: "
            f"{'.'.join(a.key for a in axes)}"
        )
    options = {a.key: code for a, code in zip(axes, fields[6:], strict=True)}
    return make_variant(target, scene, model, stepper, int(width[1:]), **options)


def _stepper_of(name: str, goal: str) -> Stepper:
    if name != "euler" and name not in TABLEAUS:
        raise ValueError(f"'{name}' is no stepper; there are euler, {', '.join(TABLEAUS)}")
    if name == "euler" and re.fullmatch(r"n[1-9][0-9]*", goal):
        return Stepper(name, steps=int(goal[1:]))
    if name != "euler" and re.fullmatch(r"e[0-9](p[0-9]+)?m[0-9]+", goal):
        return Stepper(name, budget=budget_of(goal))
    expected = "n<steps> as n1000" if name == "euler" else "e<budget> as e1m06"
    raise ValueError(f"'{goal}' is no goal of {name}; expected {expected}")
