"""Candidates of two balls by target, scene and model, as tests ask for them."""

from __future__ import annotations

from collections.abc import Iterable

from generator.choice import candidates
from generator.registry.question import Goal
from generator.registry.variant import Variant
from generator.targets.target import Target


def fixed_step_candidates(
    target: Target, scene: str, model: str, steps: int, compilers: Iterable[str]
) -> list[Variant]:
    contest = candidates.contest_for(target, scene, model, Goal(steps=steps))
    return candidates.fixed_step_candidates(contest, compilers)


def exact_candidates(
    target: Target,
    scene: str,
    model: str,
    budget: float,
    compilers: Iterable[str],
    reproducible: bool = False,
) -> list[Variant]:
    contest = candidates.contest_for(target, scene, model, Goal(budget=budget))
    return candidates.exact_candidates(contest, compilers, reproducible)


def baseline(target: Target, scene: str, model: str, compilers: Iterable[str]) -> Variant:
    return candidates.baseline(
        candidates.contest_for(target, scene, model, Goal(steps=1)), compilers
    )


def default_kernel(target: Target, scene: str, model: str, goal: Goal) -> Variant:
    return candidates.default_kernel(candidates.contest_for(target, scene, model, goal))
