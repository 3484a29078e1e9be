"""What a report takes its figures from: which finals, which sources, which cases."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from generator.choice.kernel import Verified
from generator.choice.verifying import Expected, HardCases
from generator.evidence.timing.plan import TimingPlan
from generator.evidence.verification.verdict import Verdict
from generator.registry.variant import Stepper, make_variant
from generator.report.experiments.subjects import Called
from generator.report.experiments.times import time_calls
from generator.report.findings import ROOMS
from generator.report.known import last_finals
from generator.sweep.store import opened
from generator.targets.target import find_target
from generator.toolchain.build import BuiltLibrary
from tests.support.sweep_lab import EXACT, FakeLab, plan, swept


def test_a_re_timing_does_not_take_the_place_of_the_choice(tmp_path: Path) -> None:
    with opened(tmp_path / "s.sqlite") as store:
        outcomes, _ = swept(store, FakeLab(), plan(EXACT, trials=8))
    choice = outcomes[0].final
    assert choice is not None
    again = choice.model_copy(update={"purpose": "verify-choice", "chosen": "another"})
    found = last_finals([choice, again], "zen3", "any", "pooltool")
    assert [final.chosen for final in found.values()] == [choice.chosen]


def test_a_measurement_is_stale_by_a_scene_and_by_a_target(tmp_path: Path) -> None:
    assert {"impacts", "targets", "lowering"} <= set(ROOMS)
    assert {"evidence/verification", "evidence/profiling"} <= set(ROOMS)
    package = Path(__file__).parents[2] / "generator"
    assert all((package / room).is_dir() for room in ROOMS)


def test_batches_of_the_page_collide_what_those_of_the_table_do() -> None:
    variant = make_variant("zen3", "any", "pooltool", Stepper("dp54", budget=1e-6), fma="fma")
    batch = np.arange(48.0).reshape(2, 24)
    plans: list[TimingPlan] = []

    class Tool:
        def time(self, asked: TimingPlan) -> Any:
            plans.append(asked)
            raise StopIteration

    class Cases:
        def timed(self, scene: str, model: str, batches: bool) -> Any:
            return batch if batches else None

    class Bench:
        tool = Tool()
        cases = Cases()

        def emit_all(self, variants: Any, target: Any) -> list[Any]:
            return list(variants)

        def build_all(self, kernels: Any) -> Any:
            return kernels

        def verify_all(self, variants: Any) -> list[Verified]:
            place = Path("/nowhere/kernel.so")
            library = BuiltLibrary(place, "key", 0.5, place, hit=False)
            passed = Verdict(True, "", 1e-9, 1e-9, 10)
            return [
                Verified(
                    variant=v,
                    source=None,  # type: ignore[arg-type]
                    compiler=None,  # type: ignore[arg-type]
                    flags=(),
                    library=library,
                    verdict=passed,
                    pooltool=None,
                )
                for v in variants
            ]

        def progress(self, what: str, done: int, of: int) -> None: ...

    empty = np.zeros((0, 24))
    expected = Expected(
        "any", empty, empty, None, 0, 1, (), None, "key", HardCases(empty, empty, empty)
    )
    called = [Called("E", variant, False), Called("E", variant, True)]
    with pytest.raises(StopIteration):
        time_calls(Bench(), called, find_target("zen3"), expected, 1.0)  # type: ignore[arg-type]
    assert plans[0].cases is batch
