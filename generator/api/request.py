"""What a caller asks for, by name, and what that stands for."""

from __future__ import annotations

from dataclasses import dataclass

from ..choice.candidates import candidates_of
from ..choice.lookup import batch_kernel_for, entries_for, kernel_for
from ..choice.selection import how_to_make, place_of
from ..errors import InputError
from ..evidence.verification.evidence import evidence_of
from ..impacts.impact import Impact
from ..impacts.scene import BaseScene
from ..registry.names import question_named, variant_named
from ..registry.question import DEFAULT_IMPACT, Contest, Goal, find_impact
from ..registry.variant import Variant
from ..targets.host import Host, read_host
from ..targets.target import Target
from .session import Session, resolve_target


@dataclass(frozen=True)
class Request:
    """Which kernel a caller wants, by name.

    `target`: a CPU of `targets()`, or `native`. `scene`, `model`: of `scenes()` and `models()`; no
    model: the scene's. `steps` of the fixed-step scheme, or `max_error` against the exact solution
    over the relative speed; neither: the scene's own largest error. `batch`: in lanes. `impact`:
    what collides.
    """

    target: str = "native"
    scene: str = "any"
    model: str | None = None
    steps: int | None = None
    max_error: float | None = None
    batch: bool = False
    impact: str = DEFAULT_IMPACT

    def goal(self) -> Goal:
        """The steps or the budget. Raises InputError where both are named, or one cannot be."""
        impact = find_impact(self.impact)
        known = impact.find_scene(self.scene)
        if self.steps is not None and self.max_error is not None:
            raise InputError("--steps and --max-error exclude each other: name one of them")
        if self.steps is not None:
            if not known.fixed_steps:
                raise InputError(
                    f"--steps: scene {self.scene} has no fixed-step scheme; use --max-error"
                )
            return Goal(self.steps, None)
        budget = known.max_error if self.max_error is None else self.max_error
        candidates_of(impact).tableaus_for(budget)
        known.require_budget(budget)
        return Goal(None, budget)

    def resolved(self) -> Resolved:
        """What the names stand for. Raises InputError that names the one there is not."""
        impact = find_impact(self.impact)
        target, host = resolve_target(self.target)
        scene = impact.find_scene(self.scene)
        model, goal = impact.find_model(self.model or scene.model).name, self.goal()
        require_reachable(impact, model, goal)
        return Resolved(self, target, host, scene, model, goal)


def require_reachable(impact: Impact, model: str, goal: Goal) -> None:
    """Raise InputError where a budget is asked of a model that is defined by its steps alone."""
    if goal.budget is not None and model in evidence_of(impact).exact_models:
        raise InputError(f"--max-error: model {model} has fixed steps alone; name --steps")


@dataclass(frozen=True)
class Resolved:
    """A request whose names were all found. `host`: the machine that this runs on."""

    request: Request
    target: Target
    host: Host
    scene: BaseScene
    model: str
    goal: Goal

    def kernel(self, session: Session) -> Variant:
        """The chosen kernel, or what is used before anything was timed."""
        find = batch_kernel_for if self.request.batch else kernel_for
        return find(session.generated, self.request.target, self.contest)

    @property
    def contest(self) -> Contest:
        asked = self.request
        head = asked.impact, self.target.name, self.scene.name, self.model, self.goal
        return Contest(*head, "batch" if asked.batch else "scalar")

    @property
    def impact(self) -> Impact:
        return find_impact(self.request.impact)


def kernel_named(text: str, session: Session) -> Variant:
    """The kernel that a user names: a question or its file, and a recipe; else the chosen one.

    As a target `native` is this host's CPU. InputError says what is wrong with it.
    """
    first, *recipe = text.split() or [""]
    question = question_named(first, read_host().target.name)
    if recipe:
        return variant_named(f"{question} {' '.join(recipe)}")
    place = place_of(session.generated, question.target, question.scene, question.impact)
    chosen = entries_for(session.generated, question)
    if not chosen:
        raise InputError(
            f"{question}: none was chosen; name a recipe after it, as dp54 root=est1, or run "
            f"{how_to_make(place)}"
        )
    return chosen[0].variant
