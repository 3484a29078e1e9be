"""The row of the registry, with all that it names: a real impact has a module for each."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any, ClassVar

from generator.impacts.columns import Columns, Parameter
from generator.impacts.impact import Body, Functions, Impact, Result, Sensitivity, Status, Words
from generator.impacts.scene import BaseScene

PARAMETERS = (
    Parameter("R", "m", 1e-9, 1e3, "radius of the puck"),
    Parameter("e", "1", 0.0, 1.0, "restitution at the wall"),
)
NAMES = tuple(parameter.name for parameter in PARAMETERS)
COLUMNS = Columns(parameters=NAMES, motion=("vx", "vy", "nx", "ny"), velocities=("vx", "vy"))
SOURCE = "Source: none, it is made up."
STATE = "Units: m, s. Puck: 2 doubles, its velocity; normal: 2 of length 1, into the wall."
NO_FIXED_STEPS = "there are no fixed steps"


class Model:
    name, text = "rigid", "the wall does not yield"


class Scene(BaseScene):
    limits: ClassVar[Mapping[str, tuple[float, float]]] = {
        p.name: (p.low, p.high) for p in PARAMETERS
    }
    models: ClassVar[tuple[str, ...]] = (Model.name,)
    model: str = Model.name

    @property
    def closed_form(self) -> str:
        return "a puck without friction"

    @property
    def fixed_steps(self) -> bool:
        return False


def meaning(key: str, scene: Scene) -> str:
    return next(f"{p.unit}, {p.meaning}" for p in PARAMETERS if p.name == key)


def check(key: str, scene: Scene) -> str:
    low, high = scene.range_of(key)
    return f"in_range(p.{key}, {low!r}, {high!r})"


def joint_checks(scene: Scene) -> tuple[str, ...]:
    return ()


def contract(scene: Scene, model_name: str, method: tuple[str, ...]) -> tuple[str, ...]:
    return ("A puck against a wall.", *method, STATE, SOURCE)


def scene_lines(scene: Scene) -> tuple[str, ...]:
    return ()


def varied_note(scene: Scene) -> str:
    return "e may be NULL (then p decides)"


def case_value(key: str, row: str) -> str:
    return f"{row}[{NAMES.index(key)}]"


def _words() -> Words:
    words: Any = sys.modules[__name__]
    return words


WALL = Impact(
    name="puck-wall",
    package=__name__.rpartition(".")[0],
    text="a puck without friction and a wall",
    parameters=PARAMETERS,
    columns=COLUMNS,
    functions=Functions(
        prefix="wall_",
        bodies=(Body("puck", 2), Body("normal", 2)),
        results=(Result("out", "puck", 2, 0, 2),),
        varied="e",
    ),
    statuses=(
        Status("OK", 0, "collided"),
        Status("SEPARATING", 1, "leaves the wall: velocity as it came"),
        Status("BAD_INPUT", 2, "out of range: velocity as it came"),
    ),
    ends="at once",
    relative_to="the speed |v|",
    default_model=Model.name,
    has_kernels=True,
    model_table=lambda: (Model(),),
    scene_table=lambda: {"any": Scene(name="any", text="every puck")},
    words=_words,
    sensitivity=lambda model: Sensitivity(1.0, adds_up=False),
    axes=frozenset({"fma", "compiler", "flags"}),
)
