"""A scene: which parameters are fixed, what ranges and motions occur. Read from TOML, data only.

Every key changes the emitted code; one that could not is refused with the reason.
"""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from ...errors import InputError
from .models import MODELS
from .terms import MASS_RATIOS

PARAMETERS = ("R", "M", "u_s1", "u_s2", "u_b", "e_b")
UNITS = {"R": "m", "M": "kg", "M1": "kg", "u_s1": "1", "u_s2": "1", "u_b": "1", "e_b": "1"}
# What the mechanics admits whatever the scene; R and M are divided by.
LIMITS = {
    "R": (1e-9, 1e3),
    "M": (1e-9, 1e6),
    "u_s1": (0.0, 1.0),
    "u_s2": (0.0, 1.0),
    "u_b": (0.0, 1.0),
    "e_b": (0.0, 1.0),
}
TABLE_FRICTION = ("u_s1", "u_s2")
# Where both masses are given, cases have this one for ball 1 and their own M for ball 2.
CASE_M1 = 0.25  # kg
SPEED_LIMITS = (1e-6, 1e6)  # m/s; where speeds are known to lie within, no square needs scaling
FLOAT_BUDGET = 1e-4  # the tightest for single calls in floats, whose frame is in floats too
# Alciatore's ball-ball friction, u_b = a + b exp(-c slip), slip in m/s before the collision
# (Alciatore, TP A.14; a fit to Marlow's measurements).
ALCIATORE = (9.951e-3, 0.108, 1.088)

Parameter = Literal["R", "M", "u_s1", "u_s2", "u_b", "e_b"]
Bound = Annotated[float, Field(allow_inf_nan=False, ge=0)]
Speed = Annotated[float, Field(ge=SPEED_LIMITS[0], le=SPEED_LIMITS[1])]


def _pair(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


Range = Annotated[tuple[Bound, Bound], BeforeValidator(_pair)]
SpeedRange = Annotated[tuple[Speed, Speed], BeforeValidator(_pair)]
Ratio = Annotated[float, Field(ge=MASS_RATIOS[0], le=MASS_RATIOS[1])] | Literal["given"]


class Scene(BaseModel):
    """One scene file. Unknown keys, other types and keys without effect are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    name: str = Field(pattern=r"^[a-z][a-z0-9_]*$")
    text: Annotated[str, Field(pattern=r"^[ -~]+$", max_length=200)]
    fixed: dict[Parameter, Bound] = {}
    ranges: dict[Parameter, Range] = {}
    speed: SpeedRange | None = None  # |v1 - v2| before, m/s
    spin_speed: Speed | None = None  # R |w| of either ball before is at most this, m/s
    spin: Literal["any", "side", "none"] = "any"  # side: about the vertical axis alone
    object_ball: Literal["any", "rest"] = "any"  # ball 2
    table_friction: bool = True
    equal_table: bool = False  # u_s1 = u_s2
    friction_law: Literal["given", "alciatore"] = "given"
    precision: Literal["double", "float"] = "double"  # of the stepper
    mass_ratio: Ratio = 1.0  # ball 1 to ball 2; M is that of ball 2, M1 that of ball 1 if given
    model: str = "mathavan2014"
    max_error: Annotated[float, Field(ge=1e-12, le=0.1)] = 1e-6

    @model_validator(mode="after")
    def _consistent(self) -> Scene:
        for check in (self._parameters, self._table, self._friction, self._motions, self._method):
            problem = check()
            if problem:
                raise ValueError(problem)
        return self

    def _parameters(self) -> str:
        if "*/" in self.text:
            return "text: it becomes part of a C comment; expected no */ in it"
        for key, value in self.fixed.items():
            low, high = LIMITS[key]
            if not low <= value <= high:
                return f"fixed.{key}: {value:g} is out of range; expected {low:g} to {high:g}"
        for key, (low, high) in self.ranges.items():
            least, most = LIMITS[key]
            if key in self.fixed:
                return f"ranges.{key}: {key} is fixed, so it has no range; remove one of the two"
            if not least <= low < high <= most:
                return (
                    f"ranges.{key}: [{low:g}, {high:g}] is no range; expected two numbers from "
                    f"{least:g} to {most:g}, the lower one first (one value alone goes to fixed)"
                )
        return ""

    def _table(self) -> str:
        stated = [
            k for part in ("fixed", "ranges") for k in TABLE_FRICTION if k in self._part(part)
        ]
        if not self.table_friction and stated:
            return f"table_friction: false leaves no {stated[0]} to state; remove one of the two"
        if not self.equal_table:
            return ""
        if not self.table_friction:
            return "equal_table: there is no table friction; remove it"
        if self.level:
            return f"equal_table: without effect, spin = '{self.spin}' presses no ball; remove it"
        if any(key in self.fixed for key in TABLE_FRICTION):
            return "equal_table: without effect where u_s1 or u_s2 is fixed; fix both to one value"
        if self.ranges.get("u_s1") != self.ranges.get("u_s2"):
            return "equal_table: ranges of u_s1 and u_s2 differ; expected the same or none"
        return ""

    def _friction(self) -> str:
        if self.friction_law == "alciatore":
            for part in ("fixed", "ranges"):
                if "u_b" in self._part(part):
                    return f"friction_law: 'alciatore' makes u_b, so {part}.u_b has no effect"
        return ""

    def _motions(self) -> str:
        if self.speed is not None and not self.speed[0] < self.speed[1]:
            return f"speed: [{self.speed[0]:g}, {self.speed[1]:g}]; expected the lower speed first"
        if self.spin_speed is not None and self.spin == "none":
            return "spin_speed: without effect where spin = 'none'; remove it"
        return ""

    def _method(self) -> str:
        if self.model not in [m.name for m in MODELS]:
            names = ", ".join(m.name for m in MODELS)
            return f"model: no model '{self.model}'; there are {names}"
        if not self.equal_masses and not self.table_friction and not self.level:
            return "mass_ratio: only 1 without table friction; expected table_friction = true"
        if self.masses_given and ("M" in self.fixed or "M" in self.ranges):
            return "mass_ratio: 'given' gives both masses with the call; remove M from the scene"
        if self.precision == "float" and self.level:
            return f"precision: without effect, spin = '{self.spin}' has a closed form; remove it"
        if self.precision == "float" and self.max_error < FLOAT_BUDGET:
            return (
                f"max_error: {self.max_error:g} is beyond float arithmetic; expected at least "
                f"{FLOAT_BUDGET:g}, or precision = 'double'"
            )
        return ""

    def _part(self, name: str) -> dict[Parameter, Any]:
        return self.fixed if name == "fixed" else self.ranges

    # -- what follows from the statements --

    @property
    def level(self) -> bool:
        """Is there no vertical contact slip? Then no ball is pressed, and all is closed form."""
        return self.spin != "any"

    @property
    def one_table(self) -> bool:
        """Is table friction the same for both balls?"""
        same = self.fixed.get("u_s1", 1.0) == self.fixed.get("u_s2", 2.0)
        return self.equal_table or same

    @property
    def bounded(self) -> bool:
        """Are all speeds known to be such that their squares are ordinary numbers?"""
        return self.speed is not None and self.spin_speed is not None and self.object_ball == "rest"

    @property
    def masses_given(self) -> bool:
        """Do both masses come with the call, M1 and M?"""
        return self.mass_ratio == "given"

    @property
    def equal_masses(self) -> bool:
        return self.mass_ratio == 1

    @property
    def fixed_steps(self) -> bool:
        """Has it fixed-step kernels? That scheme is pooltool's: of equal balls and in double."""
        return self.equal_masses and self.precision == "double"

    @property
    def without_exact_lanes(self) -> str:
        """Why exact kernels of the scene have one lane alone; empty where they may have more."""
        if self.level:
            return ""  # a closed form, whatever else there is
        if not self.table_friction:
            return "no table friction"
        if not self.equal_masses:
            return "unequal masses"
        return ""

    @property
    def unrestricted(self) -> bool:
        """Is every case of the envelope of real use a case of this scene?"""
        plain = Scene(name=self.name, text=self.text, model=self.model, max_error=self.max_error)
        return self == plain

    @property
    def members(self) -> tuple[str, ...]:
        """All parameters, given or not, in the order of carom_params."""
        return tuple(key for key in UNITS if key != "M1" or self.masses_given)

    @property
    def free(self) -> tuple[str, ...]:
        """The parameters that a caller gives, in the order of carom_params."""
        given = tuple(key for key in self.members if key not in self.fixed)
        if self.friction_law == "alciatore":
            given = tuple(key for key in given if key != "u_b")
        if not self.table_friction:
            given = tuple(key for key in given if key not in TABLE_FRICTION)
        return given

    def range_of(self, key: str) -> tuple[float, float]:
        return next((own for name, own in self.ranges.items() if name == key), LIMITS[key])

    def require_budget(self, budget: float) -> None:
        """Raise InputError where the scene's arithmetic cannot hold an error budget."""
        if self.precision == "float" and budget < FLOAT_BUDGET:
            raise InputError(
                f"--max-error {budget:g}: beyond the float arithmetic of scene {self.name}; "
                f"expected at least {FLOAT_BUDGET:g}"
            )


_BRANCHES = ("[key]", "constrained-float", "literal['given']")  # where pydantic was, not the user


def case_value(key: str, row: str) -> str:
    """A parameter of a case as C++ text, its six from the array `row`."""
    return repr(CASE_M1) if key == "M1" else f"{row}[{PARAMETERS.index(key)}]"


def _problem(error: ValidationError) -> str:
    """The first thing that is wrong, as `key ...: what`."""
    first = error.errors()[0]
    where = ".".join(str(part) for part in first["loc"] if part not in _BRANCHES)
    text = first["msg"].removeprefix("Value error, ").removeprefix("Assertion failed, ")
    if not where:
        return f"key {text}"
    if first["type"] == "extra_forbidden":
        text = f"no such key; there are {', '.join(Scene.model_fields)}"
    return f"key {where}: {text}"


def parse_scene(text: str, source: str) -> Scene:
    """A scene from TOML text. Raises InputError that names the file and the key."""
    try:
        return Scene(**tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{source}: not valid TOML: {error}") from None
    except ValidationError as error:
        raise InputError(f"{source}: {_problem(error)}") from None


@cache
def scenes() -> dict[str, Scene]:
    """The scenes that are shipped, by name."""
    folder = resources.files(__package__) / "scenes"
    files = sorted(f.name for f in folder.iterdir() if f.name.endswith(".toml"))
    read = {}
    for name in files:
        path = f"generator/impacts/ball_ball/scenes/{name}"
        scene = parse_scene((folder / name).read_text("utf-8"), path)
        if f"{scene.name}.toml" != name:
            raise InputError(f"{path}: key name: '{scene.name}'; expected the file's")
        read[scene.name] = scene
    return read


def find_scene(name: str) -> Scene:
    """A shipped scene by its name. Raises InputError naming the scenes there are."""
    if name not in scenes():
        raise InputError(f"--scene {name}: no such scene; there are {', '.join(scenes())}")
    return scenes()[name]
