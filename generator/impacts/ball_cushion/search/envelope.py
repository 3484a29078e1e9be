"""Where a search looks: the ranges of a scene, or of real use."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ....evidence.challenge.place import Extent
from ....evidence.challenge.ranges import Bounds, cut, known_range, usual
from ..scene import Scene

_RADIUS = 0.03125  # m: a power of two, so that R w is exactly what it was made from
_MASS = 0.170097
MOST_ANGLES = 85.0  # degrees, of theta + atan u_s + atan u_w: beyond, compression all but jams
# Up to where the promise is made; `nose` is h / R.
_DOCUMENTED = {"u_s": (0.0, 0.8), "u_w": (0.0, 0.6), "e_c": (0.0, 1.0), "nose": (1.0, 1.6)}
_REAL = {"u_s": (0.0, 0.5), "u_w": (0.0, 0.5), "e_c": (0.5, 1.0), "nose": (1.0, 1.45)}
REAL_SPEED, REAL_SPIN = 12.0, 20.0  # m/s: of v and of R w


@dataclass(frozen=True)
class Envelope:
    """Ranges of the parameters that a search varies, and what the ball is."""

    scene: Scene
    model: str
    extent: Extent
    u_s: Bounds
    u_w: Bounds
    e_c: Bounds
    nose: Bounds  # h / R
    radius: float
    mass: float

    @property
    def ranges(self) -> Mapping[str, Bounds]:
        return {"u_s": self.u_s, "u_w": self.u_w, "e_c": self.e_c, "h/R": self.nose}


def envelope(scene: Scene, model: str, extent: Extent) -> Envelope:
    """The scene's ranges as far as the promise goes, cut down to real use if asked."""
    radius, mass = usual(scene, "R", _RADIUS), usual(scene, "M", _MASS)
    limits = _REAL if extent == "real" else _DOCUMENTED
    heights = known_range(scene, "h")
    of = {key: known_range(scene, key) for key in ("u_s", "u_w", "e_c")}
    of["nose"] = (heights[0] / radius, heights[1] / radius)
    within = {key: cut(bounds, limits[key]) for key, bounds in of.items()}
    return Envelope(scene, model, extent, **within, radius=radius, mass=mass)


def angles(nose: float, u_s: float, u_w: float) -> float:
    """theta + atan u_s + atan u_w, degrees."""
    return math.degrees(math.asin(nose - 1) + math.atan(u_s) + math.atan(u_w))
