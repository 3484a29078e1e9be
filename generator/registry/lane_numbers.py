"""Which numbers the lanes of a kernel hold."""

from __future__ import annotations

from ..impacts.scene import BaseScene
from ..targets.target import Target
from .lanes import Precision, widths_of
from .roots import allows_floats
from .variant import Variant


def precision_of(variant: Variant) -> Precision:
    """Of the numbers in a kernel's lanes; of a kernel without lanes: the scene's."""
    own: Precision = variant.question.known_scene.precision
    return "float" if variant.get("numbers") == "float" else own


def steps_in_doubles(scene: BaseScene) -> bool:
    """Has a scene steps, and in doubles? Only those can be made in floats instead."""
    return scene.precision == "double" and not scene.closed_form


def float_lanes(single: Variant, target: Target) -> tuple[int, ...]:
    """Numbers of lanes in which a kernel of doubles may make its steps in floats; widest first."""
    asked, budget = single.question, single.stepper.budget or 0.0
    if not (steps_in_doubles(asked.known_scene) and allows_floats(budget, asked.sensitivity)):
        return ()
    return tuple(sorted((w for w in widths_of(target, "float") if w > 1), reverse=True))


def widths_for(target: Target, scene: BaseScene, family: str) -> tuple[int, ...]:
    """Numbers of lanes, 1 among them, of kernels of a stepper family, the fewest first."""
    own = widths_of(target, scene.precision)
    return tuple(sorted({*own, *(widths_of(target, "float") if family == "exact" else ())}))
