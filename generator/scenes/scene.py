"""A scene: which parameters are fixed, what ranges and motions occur. Read from TOML, data only."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from generator.errors import InputError

PARAMETERS = ("R", "M", "u_s1", "u_s2", "u_b", "e_b")
UNITS = {"R": "m", "M": "kg", "u_s1": "1", "u_s2": "1", "u_b": "1", "e_b": "1"}
# What the mechanics admits whatever the scene; R and M are divided by.
LIMITS = {
    "R": (1e-9, 1e3),
    "M": (1e-9, 1e6),
    "u_s1": (0.0, 1.0),
    "u_s2": (0.0, 1.0),
    "u_b": (0.0, 1.0),
    "e_b": (0.0, 1.0),
}

Parameter = Literal["R", "M", "u_s1", "u_s2", "u_b", "e_b"]
Bound = Annotated[float, Field(allow_inf_nan=False, ge=0)]


class Scene(BaseModel):
    """One scene file. Unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str = Field(pattern=r"^[a-z][a-z0-9_]*$")
    text: str
    fixed: dict[Parameter, Bound] = {}
    ranges: dict[Parameter, tuple[Bound, Bound]] = {}
    spin: Literal["any", "side", "none"] = "any"
    object_ball: Literal["any", "rest"] = "any"
    table_friction: bool = True
    equal_table: bool = False
    friction_law: Literal["given", "alciatore"] = "given"
    precision: Literal["double", "float"] = "double"
    mass_ratio: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 1.0  # ball 1 to ball 2
    model: str = "mathavan2014"
    max_error: Annotated[float, Field(gt=0, le=0.1)] = 1e-6

    @model_validator(mode="after")
    def _consistent(self) -> Scene:
        for key, (low, high) in self.ranges.items():
            if low > high:
                raise ValueError(f"ranges.{key}: the lower bound {low} is above {high}")
            if key in self.fixed:
                raise ValueError(f"ranges.{key}: {key} is fixed, so it has no range")
        for key, value in self.fixed.items():
            low, high = LIMITS[key]
            if not low <= value <= high:
                raise ValueError(f"fixed.{key}: {value} is outside {low} to {high}")
        return self

    @property
    def free(self) -> tuple[str, ...]:
        """The parameters that a caller gives, in the order of carom_params."""
        given = tuple(key for key in PARAMETERS if key not in self.fixed)
        if self.friction_law == "alciatore":
            given = tuple(key for key in given if key != "u_b")
        if not self.table_friction:
            given = tuple(key for key in given if key not in ("u_s1", "u_s2"))
        return given

    def range_of(self, key: str) -> tuple[float, float]:
        return self.ranges.get(key, LIMITS[key])  # type: ignore[call-overload]


def parse_scene(text: str, source: str) -> Scene:
    """A scene from TOML text. Raises InputError that names the file and the key."""
    try:
        return Scene(**tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{source}: not valid TOML: {error}") from None
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{source}: key {where or '(scene)'}: {first['msg']}") from None
    except TypeError as error:
        raise InputError(f"{source}: {error}") from None


@cache
def scenes() -> dict[str, Scene]:
    """The scenes that are shipped, by name."""
    folder = resources.files("generator.scenes")
    files = sorted(f.name for f in folder.iterdir() if f.name.endswith(".toml"))
    read = [parse_scene((folder / f).read_text("utf-8"), f"generator/scenes/{f}") for f in files]
    return {scene.name: scene for scene in read}


def find_scene(name: str) -> Scene:
    """A shipped scene by its name. Raises InputError naming the scenes there are."""
    if name not in scenes():
        raise InputError(f"--scene {name}: no such scene; there are {', '.join(scenes())}")
    return scenes()[name]
