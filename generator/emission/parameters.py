"""The parameters of a kernel as the templates show them."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from ..impacts.impact import Impact
from ..impacts.scene import BaseScene
from ..lowering.printer import number
from .context import Field


@dataclass(frozen=True)
class Fields:
    """Constants, members of `Parameters`, and those of them that the caller gives."""

    fixed: tuple[Field, ...]
    free: tuple[Field, ...]
    given: tuple[Field, ...]  # the members of the struct, in their order
    checks: tuple[str, ...]  # conditions on them


def fields_of(impact: Impact, scene: BaseScene) -> Fields:
    values, words = scene.constants, impact.words()
    fixed = tuple(
        Field(key, words.meaning(key, scene), number(sp.Float(values[key], 17)))
        for key in scene.members
        if key in values
    )
    free = tuple(
        Field(key, words.meaning(key, scene), check=words.check(key, scene))
        for key in scene.members
        if key not in values
    )
    given = tuple(f for f in free if f.name in scene.free)
    return Fields(fixed, free, given, (*(f.check for f in given), *words.joint_checks(scene)))
