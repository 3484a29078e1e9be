"""A kernel's answers to many cases, and what is wrong with them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...impacts.columns import Columns
from ..timing.bench_tool import BenchTool, Method
from ..verification.errors import Array, Measure, nudged
from ..verification.evidence import evidence_of
from .place import Search, Within, search_of

_NUDGES = 16
_TIMEOUT = 300.0
# What a few roundings of a case may make of a result, in what one of them does.
ROUNDINGS = 16.0


class Answers(NamedTuple):
    """What came out of cases and what should have."""

    got: Array
    want: Array
    error: Array  # relative; infinite where the status is another
    over: Array  # error over what is allowed: the budget, or the doubles' floor where that is more


@dataclass
class Judge:
    """Runs a kernel and the oracle. Counts the cases that both have answered."""

    tool: BenchTool
    library: Path
    within: Within
    budget: float
    batch: bool
    evaluations: int = field(default=0)

    @property
    def measure(self) -> Measure:
        return evidence_of(self.tool.impact).measure

    @property
    def space(self) -> Search:
        return search_of(self.tool.impact)

    @property
    def columns(self) -> Columns:
        return self.tool.columns

    def run(self, cases: Array) -> Array:
        """What the kernel makes of cases."""
        return self.tool.run_kernel(self.library, cases, batch=self.batch, timeout=_TIMEOUT)

    def answers(self, cases: Array, method: Method = "screen") -> Answers:
        """`screen`: the oracle in double, to search by; `exact`: in long double, to confirm."""
        got, want = self.run(cases), self.expect(cases, method)
        self.evaluations += len(cases)
        error = self.measure.errors_of(cases, got, want).relative
        status = self.columns.status
        error = np.where(got[:, status] == want[:, status], error, np.inf)
        return Answers(got, want, error, error / self.allowed(cases))

    def expect(self, cases: Array, method: Method) -> Array:
        more = self.within.scene.oracle_options
        return self.tool.expect(cases, method, self.within.model, more=more, threads=1)

    def allowed(self, cases: Array) -> Array:
        return np.maximum(self.budget, self.measure.rounding_of(cases))

    def moved(self, case: Array) -> float:
        """How far the exact result moves, relative, when the case changes by last bits."""
        parameters = self.space.parameters
        cases = nudged(case, _NUDGES, (*parameters, *self.measure.moving))
        ranges = [self.tool.impact.parameters[column] for column in parameters]
        low, high = [r.low for r in ranges], [r.high for r in ranges]
        cases[:, parameters] = np.clip(cases[:, parameters], low, high)
        exact = self.expect(cases, "exact")
        own = np.tile(exact[0], (len(cases), 1))
        return float(self.measure.errors_of(cases, exact, own).relative.max())

    def difference(self, cases: Array, answers: Answers) -> Array:
        """Errors with their signs, of v and R w, relative; a row of velocities for each case."""
        velocities = slice(self.columns.status)
        wrong = answers.got[:, velocities] - answers.want[:, velocities]
        wrong[:, self.columns.spins_after] *= self.measure.radius(cases)
        relative: Array = wrong / self.measure.speed(cases)[:, None]
        return relative
