"""What is to be vendored: checked before any work is done."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from ..choice.candidates import candidates_of
from ..errors import InputError
from ..impacts.impact import Impact
from ..impacts.scene import BaseScene
from ..registry.question import DEFAULT_IMPACT, Goal, find_impact
from ..targets.target import find_target

_PREFIX = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
_LONGEST_PREFIX = 40
# A prefix is also a C++ namespace and the name of a library.
_WORDS = """
alignas alignof and asm auto bitand bitor bool break case catch char class compl concept const
consteval constexpr constinit continue decltype default delete do double else enum explicit
export extern false float for friend goto if inline int linux long main mutable namespace new
noexcept not nullptr operator or posix private protected public register requires restrict
return short signed sizeof static std struct switch template this throw true try typedef typeid
typename typeof union unix unsigned using virtual void volatile while xor
"""
_TAKEN = frozenset(_WORDS.split())


@dataclass(frozen=True)
class VendorRequest:
    """Everything that decides a vendored folder but the stored figures and the sources.

    A folder holds one impact or several: `impact` and `model` then are as many names with commas.
    """

    targets: tuple[str, ...]  # names of targets.toml, as asked for; never `native`
    scene: str
    model: str  # empty: the scenes' own
    goal: Goal
    prefix: str = "carom"
    single_header: bool = False
    reproducible: bool = False  # the same bits on every CPU of an instruction set
    impact: str = DEFAULT_IMPACT

    @property
    def parts(self) -> tuple[VendorRequest, ...]:
        """The request of each impact alone."""
        pairs = zip(self.impact.split(","), self.model.split(","), strict=True)
        return tuple(replace(self, impact=impact, model=model) for impact, model in pairs)

    @property
    def row(self) -> Impact:
        """Of a part: its impact."""
        return find_impact(self.impact)

    @property
    def known_scene(self) -> BaseScene:
        """Of a part: its impact's scene."""
        return self.row.find_scene(self.scene)

    @property
    def command(self) -> str:
        """What makes the folder again; the place is the user's own matter."""
        goal = f"--steps {self.goal.steps}" if self.goal.steps is not None else ""
        goal = goal or f"--max-error {self.goal.budget!r}"
        single = " --single-header" if self.single_header else ""
        single += " --reproducible" if self.reproducible else ""
        impact = "" if self.impact == DEFAULT_IMPACT else f" --impact {self.impact}"
        return (
            f"./gen vendor --target {','.join(self.targets)}{impact} --scene {self.scene} "
            f"--model {self.model} {goal} --prefix {self.prefix}{single} --out DIR"
        )

    @property
    def fixed_step(self) -> bool:
        return self.goal.steps is not None


def checked_prefix(prefix: str) -> str:
    """The prefix, if it can begin names in C, be a C++ namespace and a file's name."""
    if not _PREFIX.fullmatch(prefix) or len(prefix) > _LONGEST_PREFIX:
        raise InputError(
            f"--prefix '{prefix}': expected at most {_LONGEST_PREFIX} lower-case letters, digits "
            "and single underscores, a letter first, as carom or my_kernel"
        )
    if prefix in _TAKEN:
        raise InputError(f"--prefix '{prefix}': taken by C or C++; expected another, as carom")
    return prefix


def checked_targets(names: str, native: str) -> tuple[str, ...]:
    """Targets from a list with commas; `native` stands for the target of that name."""
    found = [native if name.strip() == "native" else name.strip() for name in names.split(",")]
    for name in found:
        find_target(name)
    twice = [name for name in found if found.count(name) > 1]
    if twice:
        raise InputError(f"--target {names}: {twice[0]} twice; expected each target once")
    return tuple(found)


def checked(asked: VendorRequest) -> VendorRequest:
    """A request with the scenes' own models and budget where none is named.

    Raises InputError naming the option that cannot be.
    """
    goal = asked.goal
    if goal.steps is not None and goal.budget is not None:
        raise InputError("--steps and --max-error exclude each other: name one of them")
    impacts = _names(asked.impact)
    models = _models(asked.model, impacts)
    parts = [
        _checked_part(replace(asked, impact=impact, model=model))
        for impact, model in zip(impacts, models, strict=True)
    ]
    budgets = {part.goal.budget for part in parts}
    if len(budgets) > 1:
        raise InputError(
            f"--scene {asked.scene}: the impacts' scenes have budgets of their own; name one for "
            "all by --max-error"
        )
    prefix, models = checked_prefix(asked.prefix), [part.model for part in parts]
    whole = replace(asked, impact=",".join(impacts), model=",".join(models), prefix=prefix)
    return replace(whole, goal=parts[0].goal)


def _names(impacts: str) -> list[str]:
    names = [name.strip() for name in impacts.split(",")]
    for name in names:
        find_impact(name)
        if names.count(name) > 1:
            raise InputError(f"--impact {impacts}: {name} twice; expected each impact once")
    return names


def _models(asked: str, impacts: list[str]) -> list[str]:
    """A model for each impact: one name is that of all."""
    models = [name.strip() for name in asked.split(",")]
    if len(models) == 1:
        return models * len(impacts)
    if len(models) != len(impacts):
        raise InputError(
            f"--model {asked}: {len(models)} models; expected one, or one for each of "
            f"{', '.join(impacts)} in that order"
        )
    return models


def _checked_part(asked: VendorRequest) -> VendorRequest:
    """The request of one impact, with the scene's model and budget where none is named."""
    impact, goal = asked.row, asked.goal
    known = impact.find_scene(asked.scene)
    if goal.steps is None:
        budget = goal.budget if goal.budget is not None else known.max_error
        goal = Goal(budget=budget)
        candidates_of(impact).tableaus_for(budget)
        known.require_budget(budget)
    elif not known.fixed_steps:
        raise InputError(f"--steps: scene {asked.scene} has no fixed-step scheme; use --max-error")
    if asked.reproducible:
        _require_reproducible(asked.targets, impact, known)
    return replace(asked, model=impact.find_model(asked.model or known.model).name, goal=goal)


def _require_reproducible(targets: tuple[str, ...], impact: Impact, scene: BaseScene) -> None:
    """Raise InputError where not every CPU that runs the folder can give the same bits."""
    if scene.makes_varied:
        varied = impact.functions.varied
        raise InputError(
            f"--reproducible: scene {scene.name} makes {varied} by the C library's exp, whose last "
            f"bit differs from one to another; expected a scene whose {varied} is given"
        )
    arches = [find_target(name).row.arch for name in targets]
    if len(set(arches)) < len(arches):
        raise InputError(
            f"--reproducible --target {','.join(targets)}: kernels for several instruction sets "
            "round differently; expected one target for each architecture, the oldest needed"
        )
