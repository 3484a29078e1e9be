"""What the rooms that judge kernels ask of an impact: `EVIDENCE` of its module `evidence`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from ...impacts.impact import Impact
from .errors import Array, Measure
from .reference import ReferenceFiles
from .verdict import Verdict


class SceneCases(Protocol):
    def __call__(self, scene: Any, rows: Array, model: str | None = None) -> Array:
        """Cases that lie inside a scene, made from cases of the whole envelope."""
        ...


class FixedVerdict(Protocol):
    def __call__(
        self,
        cases: Array,
        got: Array,
        euler: Array,
        exact: Array,
        steps: int,
        flip_share: float = ...,
    ) -> Verdict:
        """The verdict on a fixed-step kernel, against the scheme itself and the exact result."""
        ...


@dataclass(frozen=True)
class Evidence:
    """How kernels of an impact are judged."""

    measure: Measure
    reference: ReferenceFiles
    hard_cases: Path  # cases that once were a kernel's worst
    shared: Mapping[str, float]  # parameters of the cases that batches are timed on
    seeds: str  # how kinds begin that are timed apart from the others
    cases_for_scene: SceneCases
    fixed_verdict: FixedVerdict
    tolerance: float  # m/s, of a fixed-step kernel against the scheme
    flip_share: float  # of cases in which a fixed-step kernel may differ by a step
    # The model whose exact result fixed steps of a model come to, where it has none of its own.
    exact_models: Mapping[str, str] = field(default_factory=dict)
    level: tuple[int, ...] = ()  # columns of a case that rounding must not move
    given: Mapping[str, float] = field(default_factory=dict)  # parameters that no case has
    easy: frozenset[str] = frozenset()  # kinds that play mostly has: batches are timed on them, too


def evidence_of(impact: Impact) -> Evidence:
    evidence: Evidence = impact.part("evidence").EVIDENCE
    return evidence
