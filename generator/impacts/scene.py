"""A scene: which parameters are fixed, what ranges and motions occur. Read from TOML, data only.

Here is what the scenes of every impact share; an impact adds keys of its own. Every key changes the
emitted code; one that could not is refused with the reason.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from importlib.resources.abc import Traversable
from typing import Annotated, Any, ClassVar, Literal, Self, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from ..errors import InputError

FLOAT_BUDGET = 1e-4  # the tightest for single calls in floats, whose frame is in floats too

Bound = Annotated[float, Field(allow_inf_nan=False, ge=0)]


def pair(value: Any) -> Any:
    """A list of TOML as the tuple that a range is."""
    return tuple(value) if isinstance(value, list) else value


Range = Annotated[tuple[Bound, Bound], BeforeValidator(pair)]


class BaseScene(BaseModel):
    """One scene file. Unknown keys, other types and keys without effect are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    limits: ClassVar[Mapping[str, tuple[float, float]]]  # of each parameter, whatever the scene
    models: ClassVar[tuple[str, ...]]

    name: str = Field(pattern=r"^[a-z][a-z0-9_]*$")
    text: Annotated[str, Field(pattern=r"^[ -~]+$", max_length=200)]
    fixed: dict[str, Bound] = {}
    ranges: dict[str, Range] = {}
    precision: Literal["double", "float"] = "double"  # of the stepper
    model: str
    max_error: Annotated[float, Field(ge=1e-12, le=0.1)] = 1e-6

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        for check in self.checks():
            problem = check()
            if problem:
                raise ValueError(problem)
        return self

    def checks(self) -> tuple[Callable[[], str], ...]:
        """What each says is wrong, empty where nothing is; the first that is so is told."""
        return self._parameters, self._method

    def _parameters(self) -> str:
        if "*/" in self.text:
            return "text: it becomes part of a C comment; expected no */ in it"
        for part, table in (("fixed", self.fixed), ("ranges", self.ranges)):
            for key in table:
                if key not in self.limits:
                    return f"{part}.{key}: no such parameter; there are {', '.join(self.limits)}"
        for key, value in self.fixed.items():
            low, high = self.limits[key]
            if not low <= value <= high:
                return f"fixed.{key}: {value:g} is out of range; expected {low:g} to {high:g}"
        for key, (low, high) in self.ranges.items():
            least, most = self.limits[key]
            if key in self.fixed:
                return f"ranges.{key}: {key} is fixed, so it has no range; remove one of the two"
            if not least <= low < high <= most:
                return (
                    f"ranges.{key}: [{low:g}, {high:g}] is no range; expected two numbers from "
                    f"{least:g} to {most:g}, the lower one first (one value alone goes to fixed)"
                )
        return ""

    def _method(self) -> str:
        if self.model not in self.models:
            return f"model: no model '{self.model}'; there are {', '.join(self.models)}"
        if self.precision == "float" and self.closed_form:
            return f"precision: without effect, {self.closed_form} has a closed form; remove it"
        if self.precision == "float" and self.max_error < FLOAT_BUDGET:
            return (
                f"max_error: {self.max_error:g} is beyond float arithmetic; expected at least "
                f"{FLOAT_BUDGET:g}, or precision = 'double'"
            )
        return ""

    # -- what follows from the statements --

    @property
    def closed_form(self) -> str:
        """The key that makes every collision one without steps; empty where steps are made."""
        return ""

    @property
    def members(self) -> tuple[str, ...]:
        """All parameters, given or not, in the order of the struct."""
        return tuple(self.limits)

    @property
    def constants(self) -> Mapping[str, float]:
        """The parameters that a kernel of the scene has as constants."""
        return self.fixed

    @property
    def free(self) -> tuple[str, ...]:
        """The parameters that a caller gives, in the order of the struct."""
        return tuple(key for key in self.members if key not in self.constants)

    @property
    def makes_varied(self) -> bool:
        """Does the kernel itself make the parameter of which a batch may have many?"""
        return False

    @property
    def fixed_steps(self) -> bool:
        """Has it fixed-step kernels?"""
        return self.precision == "double"

    @property
    def without_exact_lanes(self) -> str:
        """Why exact kernels of the scene have one lane alone; empty where they may have more."""
        return ""

    @property
    def unrestricted(self) -> bool:
        """Is every case of the envelope of real use a case of this scene?"""
        own = {"name", "text", "model", "max_error"}
        return not self.model_dump(exclude=own, exclude_defaults=True)

    @property
    def oracle_options(self) -> tuple[str, ...]:
        """What the oracle must be told of the scene besides the cases, as `NAME=NUMBER`."""
        return ()

    def range_of(self, key: str) -> tuple[float, float]:
        return self.ranges.get(key, self.limits[key])

    def require_budget(self, budget: float) -> None:
        """Raise InputError where the scene's arithmetic cannot hold an error budget."""
        if self.precision == "float" and budget < FLOAT_BUDGET:
            raise InputError(
                f"--max-error {budget:g}: beyond the float arithmetic of scene {self.name}; "
                f"expected at least {FLOAT_BUDGET:g}"
            )


_BRANCHES = ("[key]", "constrained-float", "literal['given']")  # where pydantic was, not the user


def _problem(error: ValidationError, keys: str) -> str:
    """The first thing that is wrong, as `key ...: what`."""
    first = error.errors()[0]
    where = ".".join(str(part) for part in first["loc"] if part not in _BRANCHES)
    text = first["msg"].removeprefix("Value error, ").removeprefix("Assertion failed, ")
    if not where:
        return f"key {text}"
    if first["type"] == "extra_forbidden":
        text = f"no such key; there are {keys}"
    return f"key {where}: {text}"


S = TypeVar("S", bound=BaseScene)


def scene_from(kind: type[S], text: str, source: str) -> S:
    """A scene of an impact from TOML text. Raises InputError that names the file and the key."""
    try:
        return kind(**tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{source}: not valid TOML: {error}") from None
    except ValidationError as error:
        raise InputError(f"{source}: {_problem(error, ', '.join(kind.model_fields))}") from None


def scenes_in(kind: type[S], folder: Traversable, place: str) -> dict[str, S]:
    """All scenes of a folder by name; `place`: what the folder is called in errors."""
    read = {}
    for name in sorted(f.name for f in folder.iterdir() if f.name.endswith(".toml")):
        path = f"{place}/{name}"
        scene = scene_from(kind, (folder / name).read_text("utf-8"), path)
        if f"{scene.name}.toml" != name:
            raise InputError(f"{path}: key name: '{scene.name}'; expected the file's")
        read[scene.name] = scene
    return read
