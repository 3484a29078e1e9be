"""Where a search looks: the ranges of a scene, or of real use."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ....evidence.challenge.place import Extent
from ....evidence.challenge.ranges import Bounds, cut, known_range, usual
from ..models import find_model
from ..scene import Scene

_RADIUS = 0.03125  # m: a power of two, so that R w is exactly what it was made from
_MASS = 0.170097
_REAL = {"u_b": (0.0, 0.2), "u_s": (0.0, 0.5), "e_b": (0.5, 1.0)}
REAL_SPEED, REAL_SPIN = 16.0, 20.0  # m/s: of v and of R w


@dataclass(frozen=True)
class Envelope:
    """Ranges of the parameters that a search varies, and what the balls are."""

    scene: Scene
    model: str
    extent: Extent
    u_b: Bounds
    u_s: Bounds
    e_b: Bounds
    radius: float
    mass: float

    @property
    def ranges(self) -> Mapping[str, Bounds]:
        return {"u_b": self.u_b, "u_s": self.u_s, "e_b": self.e_b}


def envelope(scene: Scene, model: str, extent: Extent) -> Envelope:
    """The scene's ranges as far as the model's promise goes, cut down to real use if asked."""

    promised = dict(find_model(model).most)

    def bounds(key: str, name: str) -> Bounds:
        low, high = known_range(scene, key)
        promise = low, max(low, min(high, promised.get(name, high)))
        return cut(promise, _REAL[name]) if extent == "real" else promise

    table = bounds("u_s1", "u_s") if scene.table_friction else (0.0, 0.0)
    return Envelope(
        scene,
        model,
        extent,
        bounds("u_b", "u_b"),
        table,
        bounds("e_b", "e_b"),
        usual(scene, "R", _RADIUS),
        usual(scene, "M", _MASS),
    )
