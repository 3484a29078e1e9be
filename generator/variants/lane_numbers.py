"""Which numbers the lanes of a kernel hold, and how tight a budget floats are good for."""

from __future__ import annotations

from generator.mechanics.terms import drives_its_slip
from generator.scenes.models import find_model
from generator.scenes.scene import find_scene
from generator.targets.target import Target
from generator.variants.lanes import Precision, widths_of
from generator.variants.variant import Variant

# What the rounding of floats adds up to in a collision, relative to |v1 - v2|, with a margin: it
# added up to 2e-7 to the errors of 352,840 hard cases by kind (docs/batches.md).
FLOAT_ROUNDING = 5 * 2.0**-24
# Of the budget, the rest of which is for the steps. Where the table drives its slip away from zero,
# an error grows with the slip.
_SHARE, _SHARE_OF_DRIVEN_SLIP = 1 / 3, 1 / 24


def precision_of(variant: Variant) -> Precision:
    """Of the numbers in a kernel's lanes; of a kernel without lanes: the scene's."""
    own: Precision = find_scene(variant.scene).precision
    return "float" if variant.get("numbers") == "float" else own


def allows_floats(budget: float, model: str) -> bool:
    """May the steps of a collision be made in floats?"""
    driven = drives_its_slip(find_model(model).terms)
    return budget * (_SHARE_OF_DRIVEN_SLIP if driven else _SHARE) >= FLOAT_ROUNDING


def steps_in_doubles(scene: str) -> bool:
    """Has a scene steps, and in doubles? Only those can be made in floats instead."""
    known = find_scene(scene)
    return known.precision == "double" and not known.level


def float_lanes(single: Variant, target: Target) -> tuple[int, ...]:
    """Numbers of lanes in which a kernel of doubles may make its steps in floats; widest first."""
    budget = single.stepper.budget or 0.0
    if not (steps_in_doubles(single.scene) and allows_floats(budget, single.model)):
        return ()
    return tuple(sorted((w for w in widths_of(target, "float") if w > 1), reverse=True))


def widths_for(target: Target, scene: str, family: str) -> tuple[int, ...]:
    """Numbers of lanes, 1 among them, of kernels of a stepper family, the fewest first."""
    own = widths_of(target, find_scene(scene).precision)
    return tuple(sorted({*own, *(widths_of(target, "float") if family == "exact" else ())}))
