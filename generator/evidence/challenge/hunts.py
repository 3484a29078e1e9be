"""What a search may be after besides the largest error: a score for rows of cases each."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Literal

import numpy as np

from ..verification.errors import Array
from .islands import Score
from .judge import Judge

Hunt = Literal["error", "jump", "energy", "symmetry", "slow"]
JUMP = 0.1  # of the budget: by how much more than the exact results those of neighbours may differ
_APART = 1e-4  # relative, of two cases between which a jump is looked for
_ROUNDS = 60  # halvings until two cases are neighbours


def score_of(hunt: Hunt, judge: Judge, count: Callable[[Array], Array] | None) -> Score:
    """What is to be as large as possible; above 1 it is beyond what a kernel promises.

    `count`: evaluations of the rates that a kernel makes for each case, for `slow`.
    """
    if hunt == "error":
        return lambda cases: judge.answers(cases).over
    if hunt == "jump":
        return lambda cases: _difference(judge, cases, _neighbours(judge, cases))
    if hunt == "energy":
        return lambda cases: growth(judge, cases)
    if hunt == "symmetry":
        return lambda cases: asymmetry(judge, cases)
    if count is None:
        raise ValueError("slow: expected a function that counts evaluations")
    return partial(_counted, judge, count)


def _counted(judge: Judge, count: Callable[[Array], Array], cases: Array) -> Array:
    judge.evaluations += len(cases)
    return count(cases)


# -- jumps --


def _neighbours(judge: Judge, cases: Array) -> Array:
    """Others close by, on a line of its own for each search; parameters only become less."""
    parameters = judge.space.parameters
    varied = (*parameters, *judge.measure.moving)
    factors = np.random.default_rng(3).uniform(-1, 1, len(varied))
    factors[: len(parameters)] = -np.abs(factors[: len(parameters)])
    for one, other in judge.space.together:
        factors[one] = factors[other]
    others = np.array(cases)
    others[:, varied] *= 1 + _APART * factors
    return others


def _difference(judge: Judge, ones: Array, others: Array) -> Array:
    """How much more two kernels' results differ than the exact ones, over the limit of a jump."""
    answers = judge.answers(np.concatenate([ones, others]))
    errors = judge.difference(np.concatenate([ones, others]), answers)
    apart = np.abs(errors[: len(ones)] - errors[len(ones) :]).max(axis=1)
    limit = np.maximum(JUMP * judge.budget, 2 * judge.measure.rounding_of(ones))
    return np.where(np.isfinite(apart), apart, 0.0) / limit


def jumps(judge: Judge, cases: Array) -> tuple[Array, Array]:
    """The cases next to the largest jump between each case and its neighbour, and how large.

    Halves the line between the two, keeping the half across which more happens.
    """
    ones, others = np.array(cases), _neighbours(judge, cases)
    for _ in range(_ROUNDS):
        middles = ones + (others - ones) / 2
        first, second = _difference(judge, ones, middles), _difference(judge, middles, others)
        keeps = (first >= second)[:, None]
        ones, others = np.where(keeps, ones, middles), np.where(keeps, middles, others)
    return ones, _difference(judge, ones, others)


# -- energy --


def growth(judge: Judge, cases: Array) -> Array:
    """By how much kinetic energy grows, as a share of it, over the budget.

    Where the model itself makes it grow: by how much more than it should.
    """
    space, within, columns = judge.space, judge.within, judge.columns
    velocities = slice(columns.status)
    before = space.energy(within, cases, cases[:, columns.before])
    if space.gains_energy(within.model):
        answers = judge.answers(cases)
        should = space.energy(within, cases, answers.want[:, velocities])
        after = space.energy(within, cases, answers.got[:, velocities])
        after = after - np.maximum(should - before, 0.0)
    else:
        judge.evaluations += len(cases)
        after = space.energy(within, cases, judge.run(cases)[:, velocities])
    return (after - before) / before / judge.budget


# -- symmetry --


def asymmetry(judge: Judge, cases: Array) -> Array:
    """How far results of a case's images differ from its own, over what is allowed."""
    own, status = judge.run(cases), judge.columns.status
    judge.evaluations += len(cases)
    worst = np.zeros(len(cases))
    for image, back in judge.space.images(judge.within, cases):
        got = judge.run(image)
        other = np.concatenate([back(got[:, :status]), got[:, status:]], axis=1)
        error = judge.measure.errors_of(cases, other, own).relative
        error = np.where(other[:, status] == own[:, status], error, np.inf)
        worst = np.maximum(worst, error)
    return worst / judge.allowed(cases)
