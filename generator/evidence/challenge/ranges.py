"""Ranges in which a search looks: what a scene says, cut to what is promised or to real use."""

from __future__ import annotations

from ...impacts.scene import BaseScene

Bounds = tuple[float, float]


def known_range(scene: BaseScene, key: str) -> Bounds:
    """Of a parameter; twice the same number where the scene fixes it."""
    if key in scene.fixed:
        return scene.fixed[key], scene.fixed[key]
    return scene.range_of(key)


def cut(bounds: Bounds, limits: Bounds) -> Bounds:
    """As much of the bounds as lies within the limits; their nearest end where none does."""
    (low, high), (least, most) = bounds, limits
    return min(max(low, least), high), max(min(high, most), low)


def usual(scene: BaseScene, key: str, value: float) -> float:
    """A parameter that is not varied: the value, or what of the scene's range is nearest to it."""
    low, high = known_range(scene, key)
    return min(max(value, low), high)
