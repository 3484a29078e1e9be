"""A question: what is wanted of a kernel, without how it is made.

    QUESTION := impact / target / scene / model - goal - width

`goal` is `n<steps>` or `e<budget>`, as `n1000` and `e2p5m06`; `width` is `x<lanes>`, with an `f`
where steps are made in lanes of floats in a scene of doubles. The file of a kernel under generated/
is its question.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Literal

from ..errors import InputError
from ..impacts import registry as impacts
from ..impacts.impact import Impact, Sensitivity
from ..impacts.scene import BaseScene
from ..targets.target import target_or_port

Family = Literal["fixed", "exact"]  # fixed steps, or as many as an error budget asks for
Call = Literal["scalar", "batch"]
CALLS: tuple[Call, ...] = ("scalar", "batch")

DEFAULT_IMPACT = impacts.DEFAULT
EXPECTED = f"IMPACT/TARGET/SCENE/MODEL-GOAL-WIDTH, as {DEFAULT_IMPACT}/zen3/any/pooltool-e1m06-x1"


@dataclass(frozen=True)
class Goal:
    """Fixed steps or an error budget: one of them."""

    steps: int | None = None
    budget: float | None = None

    @property
    def family(self) -> Family:
        return "exact" if self.steps is None else "fixed"

    def __str__(self) -> str:
        if self.steps is not None:
            return f"n{self.steps}"
        budget = self.budget or 0.0
        digits = next(text for n in range(17) if float(text := f"{budget:.{n}e}") == budget)
        return f"e{digits.replace('.', 'p').replace('e-', 'm')}"


@dataclass(frozen=True, order=True)
class Width:
    """How many collisions the batches of a kernel work on in one vector."""

    lanes: int = 1
    floats: bool = False  # steps in lanes of floats, in a scene of doubles

    def __str__(self) -> str:
        return f"x{self.lanes}{'f' if self.floats else ''}"


class _Names:
    """What the names of a question stand for; those that are not known raise InputError."""

    impact: str
    scene: str
    model: str

    @property
    def row(self) -> Impact:
        """What collides."""
        return impacts.find_impact(self.impact)

    @property
    def known_scene(self) -> BaseScene:
        return self.row.find_scene(self.scene)

    @property
    def sensitivity(self) -> Sensitivity:
        """Of its contact model."""
        return self.row.sensitivity(self.model)


@dataclass(frozen=True)
class Contest(_Names):
    """What kernels that are compared share: the question without the number of lanes.

    `target`: empty in records, which are compared whatever CPU they are of.
    """

    impact: str
    target: str
    scene: str
    model: str
    goal: Goal
    call: Call

    def __str__(self) -> str:
        fields = (self.impact, self.target, self.scene, f"{self.model}-{self.goal}-{self.call}")
        return "/".join(filter(None, fields))

    @property
    def batches(self) -> bool:
        return self.call == "batch"

    @property
    def everywhere(self) -> Contest:
        """The same on whatever CPU."""
        return replace(self, target="")


@dataclass(frozen=True)
class Question(_Names):
    """What is wanted. `checked` refuses names that are not known; nothing asks again after it."""

    impact: str
    target: str
    scene: str
    model: str
    goal: Goal
    width: Width = Width()

    def __str__(self) -> str:
        return f"{self.folder}/{self.stem}"

    @property
    def folder(self) -> str:
        """Of its file, under generated/."""
        return f"{self.impact}/{self.target}/{self.scene}"

    @property
    def stem(self) -> str:
        return f"{self.model}-{self.goal}-{self.width}"

    @property
    def file(self) -> str:
        """The name of its file in its folder."""
        return f"{self.stem}.cpp"

    @property
    def symbol(self) -> str:
        """As part of C names."""
        return symbol_of(str(self))

    @property
    def contest(self) -> Contest:
        call: Call = "batch" if self.width.lanes > 1 else "scalar"
        return Contest(self.impact, self.target, self.scene, self.model, self.goal, call)

    def checked(self) -> Question:
        """Itself. Raises InputError where impact, target, scene or model is none that there is."""
        impact = find_impact(self.impact)
        target_or_port(self.target)
        impact.find_scene(self.scene)
        impact.find_model(self.model)
        return self


def find_impact(name: str) -> Impact:
    """An impact that has kernels. Raises InputError where there is none, or where it has none."""
    impact = impacts.find_impact(name)
    if not impact.has_kernels:
        able = ", ".join(row.name for row in impacts.IMPACTS if row.has_kernels)
        raise InputError(f"--impact {name}: has no kernels yet; expected one of {able}")
    return impact


def symbol_of(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9]", "_", name)


def read_goal(text: str) -> Goal:
    """`n1000` or `e1m06` as a goal. Raises ValueError where it is none."""
    if re.fullmatch(r"n[1-9][0-9]*", text):
        return Goal(steps=int(text[1:]))
    if re.fullmatch(r"e[0-9](p[0-9]+)?m[0-9]+", text):
        return Goal(budget=float(text[1:].replace("p", ".").replace("m", "e-")))
    raise ValueError(f"'{text}' is no goal; expected n<steps> as n1000, or e<budget> as e1m06")


def read_width(text: str) -> Width:
    """`x8f` as a width. Raises ValueError where it is none."""
    found = re.fullmatch(r"x([1-9][0-9]*)(f?)", text)
    if found is None:
        raise ValueError(f"'{text}' is no width; expected x1, x4, x8f, ...")
    return Width(int(found[1]), found[2] == "f")


def read_question(text: str) -> Question:
    """Read a question back. Raises ValueError that says which field is wrong and what it may be."""
    fields = text.split("/")
    last = fields[-1].rsplit("-", 2)
    if len(fields) != 4 or len(last) != 3:
        raise ValueError(f"'{text}' is no question; expected {EXPECTED}")
    impact, target, scene = fields[:3]
    model, goal, width = last
    question = Question(impact, target, scene, model, read_goal(goal), read_width(width))
    try:
        return question.checked()
    except InputError as error:
        raise ValueError(str(error)) from None
