"""The cases that kernels are verified and timed on, with what must come out, made once each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from threading import RLock
from typing import Literal

import numpy as np

from ..evidence.records.code import key_of
from ..evidence.timing.bench_tool import BenchTool, Method
from ..evidence.verification.errors import Array
from ..evidence.verification.evidence import Evidence, evidence_of
from ..evidence.verification.hard_cases import NEIGHBOURS, load_hard, moved_by, neighbours
from ..evidence.verification.reference import load_reference
from ..impacts.impact import Impact
from ..impacts.scene import BaseScene
from ..registry.variant import Variant
from .store import Store
from .verifying import Expected, HardCases

Progress = Callable[[str, int, int], None]  # what, done, of
CaseSet = Literal["mixed", "easy"]  # all kinds, or those that play mostly has

VERIFY_SEED = 20141
VERIFY_RANDOM = 5000
TIMING_SEED = 7735
TIMING_CASES = 4096
EASY_OF = 3  # so many times as many mixed cases have as many easy ones: 25 in 47 are
EMULATED = 5  # of the cases one in so many runs under an emulator, which takes ms for each


@dataclass
class Cases:
    """Cases of any scene and model of the tool's impact. `every`: one in so many is taken."""

    tool: BenchTool
    store: Store
    progress: Progress
    every: int = 1
    _expected: dict[tuple[object, ...], Expected] = field(default_factory=dict)
    _timed: dict[tuple[str, str, bool, CaseSet], Array] = field(default_factory=dict)
    _lock: RLock = field(default_factory=RLock)

    @property
    def impact(self) -> Impact:
        return self.tool.impact

    @property
    def evidence(self) -> Evidence:
        return evidence_of(self.impact)

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
                known = self.impact.find_scene(scene)
                self._expected[key] = self._made(known, model, steps, seed, random)
                self.progress("computing expected results", 1, 1)
            return self._expected[key]

    @property
    def sets(self) -> tuple[CaseSet, ...]:
        """The sets that the impact's kernels are timed on."""
        return ("mixed", "easy") if self.evidence.easy else ("mixed",)

    def timed(self, scene: str, model: str, batches: bool = False, of: CaseSet = "mixed") -> Array:
        """The random cases that kernels are timed on, adapted to the scene.

        `batches`: with the same parameters for all but the varied one, as a batch takes them.
        """
        key = (scene, model, batches, of)
        with self._lock:
            if key not in self._timed:
                fixed = self.evidence.shared if batches else None
                known = self.impact.find_scene(scene)
                rows = self._easy(fixed) if of == "easy" else self._mixed(fixed)
                self._timed[key] = self.evidence.cases_for_scene(known, rows, model)
            return self._timed[key]

    def _mixed(self, fixed: Mapping[str, float] | None) -> Array:
        return self.tool.make_cases(TIMING_SEED, TIMING_CASES, fixed=fixed).rows

    def _easy(self, fixed: Mapping[str, float] | None) -> Array:
        """As many of the easy kinds alone, in the order in which the mixed set has them."""
        made = self.tool.make_cases(TIMING_SEED, EASY_OF * TIMING_CASES, fixed=fixed)
        easy = [kind in self.evidence.easy for kind in made.kinds]
        return made.rows[np.flatnonzero(easy)[:TIMING_CASES]]

    def _made(
        self, scene: BaseScene, model: str, steps: int | None, seed: int, random: int
    ) -> Expected:
        evidence, some = self.evidence, slice(None, None, self.every)
        made = self.tool.make_cases(seed, random, mixed=False)
        reference = load_reference(evidence.reference)
        known = reference.cases[some]
        cases = np.vstack([known, made.rows[some]])
        cases = evidence.cases_for_scene(scene, cases, model)
        nearest = evidence.exact_models.get(model, model)
        exact = self._oracle(cases, "exact", nearest, 0, scene.oracle_options)
        euler = published = None
        if steps is not None and scene.fixed_steps:
            euler = self._oracle(cases, "euler", model, steps)
        if scene.unrestricted and steps is not None:
            published = reference.published.get((model, steps))
            published = None if published is None else published[some]
        kept, rows = load_hard(evidence.hard_cases, self.impact.columns.case)
        hard = self._hard(scene, model, rows[some])
        named = zip(reference.ids, reference.kinds, strict=True)
        adapted = "reference" if scene.unrestricted else "adapted"
        labels = (
            *[f"{adapted} {i} ({kind})" for i, kind in named][some],
            *[f"random {i} ({kind})" for i, kind in enumerate(made.kinds)][some],
            *[f"hard {i} ({kind})" for i, kind in enumerate(kept)][some],
        )
        every = (cases, exact, euler, published, hard.cases, hard.exact, hard.steep)
        return Expected(
            scene=scene.name,
            cases=cases,
            exact=exact,
            euler=euler,
            reference_rows=len(known) if scene.unrestricted else 0,
            seed=seed,
            labels=labels,
            pooltool=published,
            key=key_of(*(t if t is not None else "none" for t in every)),
            hard=hard,
        )

    def _hard(self, scene: BaseScene, model: str, kept: Array) -> HardCases:
        """The kept hard cases in a scene, each with its neighbours asked for too."""
        evidence, measure = self.evidence, self.evidence.measure
        cases = evidence.cases_for_scene(scene, kept, model)
        if not len(cases):
            width = self.impact.columns.expected_width
            return HardCases(cases, np.zeros((0, width)), np.zeros(0))
        rows = neighbours(cases, measure)
        nearest = evidence.exact_models.get(model, model)
        exact = self._oracle(rows, "exact", nearest, 0, scene.oracle_options)
        steep = np.maximum(moved_by(rows, exact, measure), measure.rounding_of(cases))
        return HardCases(cases, exact[::NEIGHBOURS], steep)

    def _oracle(
        self, cases: Array, method: Method, model: str, steps: int, more: tuple[str, ...] = ()
    ) -> Array:
        key = key_of(self.tool.executable.name, cases, method, model, steps, more)
        return self.store.kept_array(
            "expected results",
            key,
            self.impact.columns.expected_width,
            lambda: self.tool.expect(cases, method, model, steps or 1, more),
        )
