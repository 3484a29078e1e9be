"""A kernel's answers to many cases, and what is wrong with them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...impacts.ball_ball.evidence.measure import (
    SPEEDS,
    STATUS,
    VELOCITIES,
    errors_of,
    relative_speed,
    rounding_of,
)
from ..timing.bench_tool import BenchTool, Method
from ..verification.errors import Array, nudged
from .envelope import Envelope

_NUDGES = 16
_TIMEOUT = 300.0
_PARAMETERS = (2, 3, 4, 5)
# What a few roundings of a case may make of a result, in what one of them does.
ROUNDINGS = 16.0


class Answers(NamedTuple):
    """What came out of cases and what should have."""

    got: Array  # rows of 13
    want: Array  # rows of 14
    error: Array  # relative; infinite where the status is another
    over: Array  # error over what is allowed: the budget, or the doubles' floor where that is more


@dataclass
class Judge:
    """Runs a kernel and the oracle. Counts the cases that both have answered."""

    tool: BenchTool
    library: Path
    within: Envelope
    budget: float
    batch: bool
    evaluations: int = field(default=0)

    def run(self, cases: Array) -> Array:
        """What the kernel makes of cases, in rows of 13."""
        return self.tool.run_kernel(self.library, cases, batch=self.batch, timeout=_TIMEOUT)

    def answers(self, cases: Array, method: Method = "screen") -> Answers:
        """`screen`: the oracle in double, to search by; `exact`: in long double, to confirm."""
        want = self.expect(cases, method)
        got = self.run(cases)
        self.evaluations += len(cases)
        error = errors_of(cases, got, want).relative
        error = np.where(got[:, STATUS] == want[:, STATUS], error, np.inf)
        return Answers(got, want, error, error / self.allowed(cases))

    def expect(self, cases: Array, method: Method) -> Array:
        more = self.within.scene.oracle_options
        return self.tool.expect(cases, method, self.within.model, more=more, threads=1)

    def allowed(self, cases: Array) -> Array:
        return np.maximum(self.budget, rounding_of(cases))

    def moved(self, case: Array) -> float:
        """How far the exact result moves, relative, when the case changes by last bits."""
        cases = nudged(case, _NUDGES, (*_PARAMETERS, *SPEEDS))
        cases[:, 2:6] = np.clip(cases[:, 2:6], 0.0, 1.0)
        exact = self.expect(cases, "exact")
        return float(errors_of(cases, exact, np.tile(exact[0], (len(cases), 1))).relative.max())

    def difference(self, cases: Array, answers: Answers) -> Array:
        """Errors with their signs, of v and R w, relative to |v1 - v2|; rows of 12."""
        wrong = answers.got[:, :VELOCITIES] - answers.want[:, :VELOCITIES]
        wrong[:, [3, 4, 5, 9, 10, 11]] *= cases[:, :1]
        relative: Array = wrong / relative_speed(cases)[:, None]
        return relative


def kinetic_energy(cases: Array, velocities: Array, mass_ratio: float | Array) -> Array:
    """Of both balls, over half the mass of ball 2; `velocities` in rows of v1, w1, v2, w2."""
    squares = velocities[:, :VELOCITIES] ** 2
    spin = 0.4 * cases[:, 0] ** 2
    one = squares[:, 0:3].sum(axis=1) + spin * squares[:, 3:6].sum(axis=1)
    two = squares[:, 6:9].sum(axis=1) + spin * squares[:, 9:12].sum(axis=1)
    total: Array = mass_ratio * one + two
    return total
