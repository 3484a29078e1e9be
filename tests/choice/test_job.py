"""The main job of a contest: which of its kernels may be chosen."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from generator.choice import job
from generator.registry.question import Contest, Goal

BENCH: Any = SimpleNamespace(
    compilers={"gcc": None}, reproducible=False, timings=SimpleNamespace(fastest=lambda *_: [])
)


@pytest.mark.parametrize(
    "impact, model", [("ball-ball", "mathavan2014"), ("ball-cushion", "clamped")]
)
@pytest.mark.parametrize(
    "goal, among", [(Goal(steps=1000), 0), (Goal(budget=1e-6), 1)], ids=["steps", "budget"]
)
def test_the_baseline_is_chosen_only_where_it_answers_the_question(
    monkeypatch: pytest.MonkeyPatch, impact: str, model: str, goal: Goal, among: int
) -> None:
    """A model may take the fixed steps for faster than an exact kernel: they are none."""
    seen: list[int] = []

    def judged(*asked: Any) -> tuple[Any, Any]:
        seen.append(asked[4])
        return asked[3], None

    monkeypatch.setattr(job, "_verified", lambda _bench, _contest, variants: list(variants))
    monkeypatch.setattr(job, "_judged", judged)
    held = job.hold(BENCH, Contest(impact, "zen3", "any", model, goal, "scalar"), BENCH, 1.0)
    print(f"{len(held.kernels)} kernels; the first that may be chosen is number {seen[0]}")
    assert seen == [among]
    goals = [variant.question.goal == goal for variant in held.kernels]  # type: ignore[union-attr]
    assert all(goals[among:]) and goals[0] is (among == 0)
