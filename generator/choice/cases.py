"""The cases that kernels are verified and timed on, with what must come out, made once each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from threading import RLock

import numpy as np

from ..evidence.records.code import key_of
from ..evidence.timing.bench_tool import BenchTool, Method
from ..evidence.verification.errors import EXPECTED_COLUMNS, Array
from ..evidence.verification.floors import rounding_of
from ..evidence.verification.hard_cases import NEIGHBOURS, load_hard, moved_by, neighbours
from ..evidence.verification.reference import EULER_STEPS, load_reference
from ..evidence.verification.scene_cases import cases_for_scene
from ..impacts.ball_ball.scene import Scene, find_scene
from ..registry.variant import Variant
from .store import Store
from .verifying import Expected, HardCases

Progress = Callable[[str, int, int], None]  # what, done, of

VERIFY_SEED = 20141
VERIFY_RANDOM = 5000
TIMING_SEED = 7735
TIMING_CASES = 4096
EMULATED = 5  # of the cases one in so many runs under an emulator, which takes ms for each
# A batch has one R, M, u_s and e_b: those of a pool table.
BATCH_PARAMETERS = {"R": 0.028575, "M": 0.170097, "u_s1": 0.2, "u_s2": 0.2, "e_b": 0.95}


@dataclass
class Cases:
    """Cases of any scene and model. `every`: one in so many is taken."""

    tool: BenchTool
    store: Store
    progress: Progress
    every: int = 1
    _expected: dict[tuple[object, ...], Expected] = field(default_factory=dict)
    _timed: dict[tuple[str, str, bool], Array] = field(default_factory=dict)
    _lock: RLock = field(default_factory=RLock)

    def of(self, variant: Variant) -> Expected:
        """Those that a kernel is verified on."""
        return self.expected(variant.scene, variant.model, variant.stepper.steps)

    def expected(
        self,
        scene: str,
        model: str,
        steps: int | None,
        seed: int = VERIFY_SEED,
        random: int = VERIFY_RANDOM,
    ) -> Expected:
        """The reference, random and kept hard cases, adapted to the scene, with their answers.

        `steps`: of fixed-step kernels; None for exact ones.
        """
        key = (scene, model, steps, seed, random)
        with self._lock:
            if key not in self._expected:
                self.progress("computing expected results", 0, 1)
                made = self._made(find_scene(scene), model, steps, seed, random)
                self._expected[key] = made if self.every == 1 else thinned(made, self.every)
                self.progress("computing expected results", 1, 1)
            return self._expected[key]

    def timed(self, scene: str, model: str, batches: bool = False) -> Array:
        """The random cases that kernels are timed on, adapted to the scene.

        `batches`: with the same parameters for all but u_b, which is what a batch can take.
        """
        key = (scene, model, batches)
        with self._lock:
            if key not in self._timed:
                fixed = BATCH_PARAMETERS if batches else None
                made = self.tool.make_cases(TIMING_SEED, TIMING_CASES, fixed=fixed).rows
                self._timed[key] = cases_for_scene(find_scene(scene), made, model)
            return self._timed[key]

    def _made(
        self, scene: Scene, model: str, steps: int | None, seed: int, random: int
    ) -> Expected:
        made, reference = self.tool.make_cases(seed, random, mixed=False), load_reference()
        cases = cases_for_scene(scene, np.vstack([reference.cases, made.rows]), model)
        exact = self._oracle(cases, "exact", model, 0, scene.oracle_options)
        euler = pooltool = None
        if steps is not None and scene.fixed_steps:
            euler = self._oracle(cases, "euler", model, steps)
        if scene.unrestricted and model == "pooltool" and steps == EULER_STEPS:
            pooltool = reference.euler_pooltool
        hard = self._hard(scene, model)
        named = zip(reference.ids, reference.kinds, strict=True)
        adapted = "reference" if scene.unrestricted else "adapted"
        labels = (
            *(f"{adapted} {i} ({kind})" for i, kind in named),
            *(f"random {i} ({kind})" for i, kind in enumerate(made.kinds)),
            *(f"hard {i} ({kind})" for i, kind in enumerate(load_hard()[0])),
        )
        every = (cases, exact, euler, pooltool, hard.cases, hard.exact, hard.steep)
        return Expected(
            scene=scene.name,
            cases=cases,
            exact=exact,
            euler=euler,
            reference_rows=len(reference.cases) if scene.unrestricted else 0,
            seed=seed,
            labels=labels,
            pooltool=pooltool,
            key=key_of(*(t if t is not None else "none" for t in every)),
            hard=hard,
        )

    def _hard(self, scene: Scene, model: str) -> HardCases:
        """The kept hard cases in a scene, each with its neighbours asked for too."""
        cases = cases_for_scene(scene, load_hard()[1], model)
        rows = neighbours(cases)
        exact = self._oracle(rows, "exact", model, 0, scene.oracle_options)
        steep = np.maximum(moved_by(rows, exact), rounding_of(cases))
        return HardCases(cases, exact[::NEIGHBOURS], steep)

    def _oracle(
        self, cases: Array, method: Method, model: str, steps: int, more: tuple[str, ...] = ()
    ) -> Array:
        key = key_of(self.tool.executable.name, cases, method, model, steps, more)
        return self.store.kept_array(
            "expected results",
            key,
            EXPECTED_COLUMNS,
            lambda: self.tool.expect(cases, method, model, steps or EULER_STEPS, more),
        )


def thinned(expected: Expected, every: int) -> Expected:
    """Every so-manieth of the cases."""
    rows = slice(None, None, every)
    labels, usual = expected.labels, len(expected.cases)
    euler, pooltool, hard = expected.euler, expected.pooltool, expected.hard
    return replace(
        expected,
        cases=expected.cases[rows],
        exact=expected.exact[rows],
        euler=None if euler is None else euler[rows],
        pooltool=None if pooltool is None else pooltool[rows],
        reference_rows=len(range(0, expected.reference_rows, every)),
        hard=HardCases(hard.cases[rows], hard.exact[rows], hard.steep[rows]),
        labels=(*labels[:usual][rows], *labels[usual:][rows]),
        key=f"{expected.key}, every {every}th",
    )
