"""Scenes of a ball and a cushion."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache
from importlib import resources
from typing import ClassVar

from ..scene import BaseScene, scene_from, scenes_in
from .models import DEFAULT_MODEL, MODELS
from .parameters import LIMITS

RIGHT_ANGLE = 90.0  # degrees, at which theta + atan u_s + atan u_w jams: compression need not end


class Scene(BaseScene):
    """A scene file of a ball and a cushion."""

    limits: ClassVar[Mapping[str, tuple[float, float]]] = LIMITS
    models: ClassVar[tuple[str, ...]] = tuple(model.name for model in MODELS)

    model: str = DEFAULT_MODEL

    def checks(self) -> tuple[Callable[[], str], ...]:
        return self._parameters, self._nose, self._method

    def _nose(self) -> str:
        height, radius = self.fixed.get("h"), self.fixed.get("R")
        if height is None or radius is None:
            return ""
        if not radius <= height < 2 * radius:
            return f"fixed.h: {height:g} with R {radius:g}; expected R to below 2 R"
        angles = [math.asin(height / radius - 1)]
        angles += [math.atan(self.fixed.get(key, self.range_of(key)[0])) for key in ("u_s", "u_w")]
        if not sum(angles) < math.radians(RIGHT_ANGLE):
            total = math.degrees(sum(angles))
            return f"fixed.h: theta + atan u_s + atan u_w is {total:g} degrees; expected below 90"
        return ""


def parse_scene(text: str, source: str) -> Scene:
    """A scene from TOML text. Raises InputError that names the file and the key."""
    return scene_from(Scene, text, source)


@cache
def scenes() -> dict[str, Scene]:
    """The scenes that are shipped, by name."""
    folder = resources.files(__package__) / "scenes"
    return scenes_in(Scene, folder, "generator/impacts/ball_cushion/scenes")
