"""What an impact is: mechanics and data, and the words for headers and errors.

One folder holds all of an impact; `impacts.registry` has one row for each. What outside these
folders still knows what collides is counted by tests/impacts/test_impacts.py. This module loads
neither SymPy nor NumPy: what needs them is a function of the row, which loads it when it is called.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from ..errors import InputError
from .columns import Columns, Parameter
from .scene import BaseScene


@dataclass(frozen=True)
class Status:
    """A value that a call returns."""

    name: str
    value: int
    text: str


@dataclass(frozen=True)
class Functions:
    """The C ABI: names behind the prefix, and the lengths of the arrays of doubles."""

    params: str  # the struct of the parameters
    collide: str
    batch: str
    bodies: tuple[tuple[str, int], ...]  # what goes in, by argument
    results: tuple[tuple[str, int], ...]  # what comes out
    batch_in: int  # arrays of a batch
    batch_out: int
    varied: str  # the parameter of which a batch may have one for each collision


class Model(Protocol):
    """A contact model: what users ask for by name."""

    @property
    def name(self) -> str: ...
    @property
    def text(self) -> str: ...


class Words(Protocol):
    """What headers, contracts and checks say; a module of the impact."""

    SOURCE: str
    STATE: str
    NO_FIXED_STEPS: str

    def meaning(self, key: str, scene: Any) -> str: ...
    def check(self, key: str, scene: Any) -> str: ...
    def joint_checks(self, scene: Any) -> tuple[str, ...]: ...
    def contract(self, scene: Any, model_name: str, method: tuple[str, ...]) -> tuple[str, ...]: ...
    def scene_lines(self, scene: Any) -> tuple[str, ...]: ...
    def varied_note(self, scene: Any) -> str: ...


@dataclass(frozen=True)
class Impact:
    """One row of the registry."""

    name: str
    text: str
    parameters: tuple[Parameter, ...]
    columns: Columns
    functions: Functions
    statuses: tuple[Status, ...]
    ends: str  # what ends the collision
    default_model: str
    has_kernels: bool  # do emission and the steppers make kernels of it?
    model_table: Callable[[], tuple[Model, ...]] = field(repr=False)
    scene_table: Callable[[], Mapping[str, BaseScene]] = field(repr=False)
    words: Callable[[], Words] = field(repr=False)

    def find_model(self, name: str) -> Model:
        """A contact model by its name. Raises InputError naming the models there are."""
        models = {model.name: model for model in self.model_table()}
        if name not in models:
            raise InputError(f"--model {name}: no such model; there are {', '.join(models)}")
        return models[name]

    def find_scene(self, name: str) -> BaseScene:
        """A shipped scene by its name. Raises InputError naming the scenes there are."""
        known = self.scene_table()
        if name not in known:
            raise InputError(f"--scene {name}: no such scene; there are {', '.join(known)}")
        return known[name]
