"""What an impact is: mechanics and data, and the words for headers and errors.

One folder holds all of an impact; `impacts.registry` has one row for each. What outside these
folders still knows what collides is counted by tests/impacts/test_impacts.py. This module loads
neither SymPy nor NumPy: what needs them is a function of the row, which loads it when it is called.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from ..errors import named
from .columns import Columns, Parameter
from .scene import BaseScene


@dataclass(frozen=True)
class Status:
    """A value that a call returns."""

    name: str
    value: int
    text: str


@dataclass(frozen=True)
class Body:
    """An array of doubles that a call is given; a batch has an array for each of its numbers."""

    name: str
    doubles: int


@dataclass(frozen=True)
class Result:
    """An array of doubles that a call gives, laid out as the body that it replaces.

    Of its numbers only `changed` of them, from `first` on, are new; a batch gives these alone.
    """

    name: str
    body: str
    doubles: int
    first: int
    changed: int


@dataclass(frozen=True)
class Functions:
    """The C ABI. Results replace the first bodies, in their order: a call may do so in place."""

    prefix: str  # behind the user's, of the struct and the functions: empty, or as `cushion_`
    bodies: tuple[Body, ...]  # what goes in
    results: tuple[Result, ...]  # what comes out
    varied: str  # the parameter of which a batch may have one for each collision

    @property
    def params(self) -> str:
        """The struct of the parameters."""
        return f"{self.prefix}params"

    @property
    def collide(self) -> str:
        return f"{self.prefix}collide"

    @property
    def steps(self) -> str:
        return f"{self.prefix}collide_steps"

    @property
    def batch(self) -> str:
        return f"{self.prefix}collide_batch"

    @property
    def kernel(self) -> str:
        return f"{self.prefix}kernel"

    @property
    def batch_in(self) -> int:
        """Arrays that a batch is given."""
        return sum(body.doubles for body in self.bodies)

    @property
    def batch_out(self) -> int:
        return sum(result.changed for result in self.results)

    def first_in(self, body: str) -> int:
        """The first array that a batch is given of a body."""
        names = [b.name for b in self.bodies]
        return sum(b.doubles for b in self.bodies[: names.index(body)])

    def first_out(self, result: str) -> int:
        """The first array that a batch gives of a result."""
        names = [r.name for r in self.results]
        return sum(r.changed for r in self.results[: names.index(result)])


@dataclass(frozen=True)
class Sensitivity:
    """What a relative error of friction does to a collision's result under a contact model."""

    amplification: float  # of it, relative to what errors are relative to; the most there is
    adds_up: bool  # do roots, rounding and steps err most in the same rare collisions?


class Model(Protocol):
    """A contact model: what users ask for by name."""

    @property
    def name(self) -> str: ...
    @property
    def terms(self) -> Any:
        """A dataclass of what the models of the impact differ in."""

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
    def case_value(self, key: str, row: str) -> str: ...


@dataclass(frozen=True)
class Impact:
    """One row of the registry."""

    name: str
    package: str  # the folder that holds it, as a Python package
    text: str
    parameters: tuple[Parameter, ...]
    columns: Columns
    functions: Functions
    statuses: tuple[Status, ...]
    ends: str  # what ends the collision
    relative_to: str  # what errors are relative to, in words and as |...|
    default_model: str
    has_kernels: bool  # do emission and the steppers make kernels of it?
    model_table: Callable[[], tuple[Model, ...]] = field(repr=False)
    scene_table: Callable[[], Mapping[str, BaseScene]] = field(repr=False)
    words: Callable[[], Words] = field(repr=False)
    sensitivity: Callable[[str], Sensitivity] = field(repr=False)  # of a contact model
    axes: frozenset[str] | None = None  # the options that its kernels have; None: all there are
    has_series: bool = False  # do its kernels know power series of the motion?

    def part(self, room: str) -> Any:
        """The module of that name in its folder: what it gives to a room above this one.

        Each room says what it wants as a Protocol and asks here: `emission` for `kernels`,
        `evidence` for `evidence`. docs/adding-an-impact.md lists them.
        """
        return importlib.import_module(f"{self.package}.{room}")

    @property
    def relative_symbol(self) -> str:
        return self.relative_to[self.relative_to.index("|") :]

    @property
    def folder(self) -> str:
        """Of its own in `bench/impacts`, `templates` and `tests/oracle`."""
        return self.package.rpartition(".")[2]

    def find_model(self, name: str) -> Model:
        """A contact model by its name. Raises InputError naming the models there are."""
        return named("model", name, {model.name: model for model in self.model_table()})

    def find_scene(self, name: str) -> BaseScene:
        """A shipped scene by its name. Raises InputError naming the scenes there are."""
        return named("scene", name, self.scene_table())
