"""The kernels that modules of other languages carry: every model and goal, unless fewer are chosen.

One C++ source a kernel, each with a prefix of its own, and a table that names them all. The module
takes the first row that its CPU runs.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from ..choice.candidates import contest_for, default_kernel, default_lanes
from ..emission.client_file import client_file
from ..emission.context import Naming
from ..emission.kernel_source import KernelSource, emit
from ..errors import InputError
from ..files import write_file
from ..impacts.ball_ball.models import MODELS, find_model
from ..impacts.ball_ball.parameters import PARAMETERS
from ..impacts.ball_ball.terms import MASS_RATIOS
from ..impacts.ball_cushion.row import BALL_CUSHION
from ..lowering.isa import compiled_features
from ..registry.names import name_of
from ..registry.question import DEFAULT_IMPACT, Goal, symbol_of
from ..registry.rules import broken_rule
from ..registry.variant import Variant
from ..targets.target import Target, target_or_port

SCENE = "any"
UNEQUAL, UNEQUAL_MODELS = "unequal", ("mathavan2014", "bottom_slip")  # pooltool: of equal balls
STEPS = 1000  # pooltool's default; the kernel takes any other number too
BUDGETS = (1e-3, 1e-6, 1e-9)  # loosest, so fastest, first
GOALS = (Goal(steps=STEPS), *(Goal(budget=budget) for budget in BUDGETS))
TARGETS = ("x86-64-v4", "x86-64-v3", "x86-64-v2")  # best first
ARM_TARGETS = ("armv8",)
WASM_TARGETS = ("wasm32",)
CUSHION = BALL_CUSHION.name
CUSHION_MODELS = tuple(model.name for model in BALL_CUSHION.model_table())
STEPS_ALONE = (CUSHION, "pooltool")  # an impact and model without exact kernels
# A page loads these alone of the cushion: its size, and pooltool's steps need a library's sine.
WASM_CUSHION = ("clamped",), (Goal(budget=1e-6),)
BY_ARCHITECTURE = {"x86_64": TARGETS, "aarch64": ARM_TARGETS, "wasm32": WASM_TARGETS}
# Ways of making 1/sqrt by the tightest budget that they are used for: what timing has chosen where
# it has (docs/measurements.md). The module's tests verify each on all reference cases.
_ROOTS = ((1e-3, "est0"), (1e-6, "est1"), (1e-9, "cubic"))
COMMAND = "python -m generator.clients FOLDER"


@dataclass(frozen=True)
class Choice:
    """What a module carries. Raises InputError where a name is none that there is."""

    targets: tuple[str, ...] = TARGETS  # best first
    models: tuple[str, ...] = tuple(dict.fromkeys((*(m.name for m in MODELS), *CUSHION_MODELS)))
    goals: tuple[Goal, ...] = GOALS  # of equals budgets: loosest first

    def __post_init__(self) -> None:
        for name in self.targets:
            target_or_port(name)
        for name in self.models:
            if name not in CUSHION_MODELS:
                find_model(name)
        if not (self.targets and self.models and self.goals):
            raise InputError("the module: expected a target, a model and a goal at least")

    @property
    def ball_models(self) -> tuple[str, ...]:
        """Those of two balls."""
        return tuple(model.name for model in MODELS if model.name in self.models)

    @property
    def cushion(self) -> tuple[tuple[str, ...], tuple[Goal, ...]]:
        """Models and goals of the cushion."""
        models, goals = CUSHION_MODELS, self.goals
        if self.targets == WASM_TARGETS:
            models, goals = WASM_CUSHION
        held = tuple(name for name in models if name in self.models)
        return held, tuple(goal for goal in goals if goal in self.goals)

    @property
    def unequal_models(self) -> tuple[str, ...]:
        """Those of balls of two masses; the interface of JavaScript gives one mass."""
        if self.targets == WASM_TARGETS:
            return ()
        return tuple(name for name in self.ball_models if name in UNEQUAL_MODELS)


@dataclass(frozen=True)
class Row:
    """One kernel of the set as the table shows it."""

    prefix: str  # of its C symbols
    target: str
    variant: Variant

    @property
    def unit(self) -> str:
        """The target as a part of C names."""
        return symbol_of(self.target)

    @property
    def model(self) -> str:
        return self.variant.model

    @property
    def unequal(self) -> bool:
        """Is it of balls of two masses?"""
        return self.variant.scene == UNEQUAL

    @property
    def parameters(self) -> str:
        """What its parameters are made from, in their order."""
        return ", ".join(f"p.{name}" for name in self.variant.question.known_scene.free)

    @property
    def steps(self) -> int:
        """N of a fixed-step kernel, 0 for others."""
        return self.variant.stepper.steps or 0

    @property
    def budget(self) -> str:
        """The budget of an exact kernel as C++ text, 0.0 for others."""
        return repr(self.variant.stepper.budget or 0.0)


def _single(target: Target, scene: str, model: str, goal: Goal, impact: str) -> Variant:
    first = default_kernel(contest_for(target, scene, model, goal, impact))
    axes = first.question.row.axes
    if goal.budget is None or (axes is not None and "root" not in axes):
        return first
    for least, root in _ROOTS:
        wanted = first.with_options(root=root)
        if goal.budget >= least and broken_rule(wanted, target) is None:
            return wanted
    return first


def _variant(target: Target, scene: str, model: str, goal: Goal, impact: str) -> Variant:
    return default_lanes(_single(target, scene, model, goal, impact), target)


def rows(choice: Choice = Choice()) -> tuple[Row, ...]:
    """The whole set: by model, then goal, then target, best first; then those of two masses."""
    exact = tuple(goal for goal in choice.goals if goal.budget is not None)
    equal = _rows(choice.targets, SCENE, choice.ball_models, choice.goals)
    return (*equal, *_rows(choice.targets, UNEQUAL, choice.unequal_models, exact))


def cushion_rows(choice: Choice = Choice()) -> tuple[Row, ...]:
    """Those of a ball and a cushion, in the same order."""
    models, goals = choice.cushion
    return tuple(_rows(choice.targets, SCENE, models, goals, CUSHION))


def _rows(
    targets: tuple[str, ...],
    scene: str,
    models: Iterable[str],
    goals: tuple[Goal, ...],
    impact: str = DEFAULT_IMPACT,
) -> Iterator[Row]:
    begin = "carom" if scene == SCENE else f"carom_{scene}"
    if impact != DEFAULT_IMPACT:
        begin += f"_{symbol_of(impact)}"
    for model in models:
        for goal in goals:
            if goal.budget is not None and (impact, model) == STEPS_ALONE:
                continue
            for name in targets:
                variant = _variant(target_or_port(name), scene, model, goal, impact)
                short = symbol_of(f"{begin}_{model}_{variant.stepper.goal}_{name}")
                yield Row(short, name, variant)


def _emit(row: Row) -> KernelSource:
    return emit(row.variant, Naming(row.prefix), COMMAND, laid_out=False)


def kernel_set(choice: Choice = Choice()) -> dict[str, str]:
    """All files of the set by name, the table among them."""
    balls, cushions = rows(choice), cushion_rows(choice)
    table = (*balls, *cushions)
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        sources = list(pool.map(_emit, table))
    files = {}
    for row, source in zip(table, sources, strict=True):
        files[f"{row.prefix}.h"] = source.header
        files[f"{row.prefix}.cpp"] = source.source
    needs = [(symbol_of(name), compiled_features(target_or_port(name))) for name in choice.targets]
    names = [name_of(row.variant) for row in table]
    files["kernel_table.cpp"] = client_file(
        "kernel_table.cpp.j2",
        COMMAND,
        names,
        rows=balls,
        cushions=cushions,
        targets=needs,
        ranges=PARAMETERS,
        cushion_ranges=BALL_CUSHION.parameters,
        ratios=MASS_RATIOS,
    )
    return files


def write_kernel_set(folder: Path, choice: Choice = Choice()) -> int:
    """Make a folder hold the set and no other source; how many files changed."""
    files = kernel_set(choice)
    changed = 0
    for name, text in files.items():
        path = folder / name
        if not path.is_file() or path.read_text("utf-8") != text:
            write_file(path, text, parents=True)
            changed += 1
    for stray in [p for p in folder.glob("*.cpp") if p.name not in files]:
        stray.unlink()
        changed += 1
    return changed
