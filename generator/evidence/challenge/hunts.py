"""What a search may be after besides the largest error: a score for rows of cases each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Literal

import numpy as np

from ...impacts.ball_ball.evidence.measure import (
    SPEEDS,
    STATUS,
    VELOCITIES,
    errors_of,
    rounding_of,
)
from ...impacts.ball_ball.evidence.scene_cases import mass_ratios
from ...impacts.ball_ball.models import find_model
from ...impacts.ball_ball.terms import drives_its_slip
from ..verification.errors import Array
from .islands import Score
from .judge import Judge, kinetic_energy

Hunt = Literal["error", "jump", "energy", "symmetry", "slow"]
HUNTS: tuple[Hunt, ...] = ("error", "jump", "energy", "symmetry", "slow")
JUMP = 0.1  # of the budget: by how much more than the exact results those of neighbours may differ
_APART = 1e-4  # relative, of two cases between which a jump is looked for
_ROUNDS = 60  # halvings until two cases are neighbours
_BALLS = (slice(6, 15), slice(15, 24))
_VARIED = (2, 3, 4, 5, *SPEEDS)


def score_of(hunt: Hunt, judge: Judge, count: Callable[[Array], Array] | None) -> Score:
    """What is to be as large as possible; above 1 it is beyond what a kernel promises.

    `count`: evaluations of the rates that a kernel makes for each case, for `slow`.
    """
    if hunt == "error":
        return lambda cases: judge.answers(cases).over
    if hunt == "jump":
        return lambda cases: _difference(judge, cases, _neighbours(cases))
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


def _neighbours(cases: Array) -> Array:
    """Others close by, on a line of its own for each search; parameters only become less."""
    factors = np.random.default_rng(3).uniform(-1, 1, len(_VARIED))
    factors[:4] = -np.abs(factors[:4])
    factors[1] = factors[0]
    others = np.array(cases)
    others[:, _VARIED] *= 1 + _APART * factors
    return others


def _difference(judge: Judge, ones: Array, others: Array) -> Array:
    """How much more two kernels' results differ than the exact ones, over the limit of a jump."""
    answers = judge.answers(np.concatenate([ones, others]))
    errors = judge.difference(np.concatenate([ones, others]), answers)
    apart = np.abs(errors[: len(ones)] - errors[len(ones) :]).max(axis=1)
    limit = np.maximum(JUMP * judge.budget, 2 * rounding_of(ones))
    return np.where(np.isfinite(apart), apart, 0.0) / limit


def jumps(judge: Judge, cases: Array) -> tuple[Array, Array]:
    """The cases next to the largest jump between each case and its neighbour, and how large.

    Halves the line between the two, keeping the half across which more happens.
    """
    ones, others = np.array(cases), _neighbours(cases)
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
    ratio = mass_ratios(judge.within.scene, cases)
    columns = [*range(9, 15), *range(18, 24)]
    before = kinetic_energy(cases, cases[:, columns], ratio)
    if drives_its_slip(find_model(judge.within.model).terms):
        answers = judge.answers(cases)
        should = kinetic_energy(cases, answers.want, ratio)
        after = kinetic_energy(cases, answers.got, ratio) - np.maximum(should - before, 0.0)
    else:
        judge.evaluations += len(cases)
        after = kinetic_energy(cases, judge.run(cases), ratio)
    return (after - before) / before / judge.budget


# -- symmetry --


def _mirrored(cases: Array) -> tuple[Array, Array]:
    """In a plane along y: speeds turn their x over, spins the other two."""
    ball = np.array([-1.0, 1, 1, -1, 1, 1, 1, -1, -1])
    signs = np.concatenate([np.ones(6), ball, ball])
    return cases * signs, np.tile(ball[3:], 2)


def _quarter(vectors: Array) -> Array:
    """Rows of vectors of three, each turned by a right angle about z."""
    table = vectors.reshape(len(vectors), -1, 3)
    return np.stack([-table[..., 1], table[..., 0], table[..., 2]], axis=-1).reshape(vectors.shape)


def _images(judge: Judge, cases: Array) -> Iterator[tuple[Array, Callable[[Array], Array]]]:
    """Cases that must come out alike, and what takes their results back."""
    mirrored, signs = _mirrored(cases)
    yield mirrored, lambda got: got * signs
    turned = np.concatenate([cases[:, :6], _quarter(cases[:, 6:])], axis=1)
    yield turned, lambda got: _quarter(_quarter(_quarter(got)))
    if judge.within.scene.unrestricted:
        one, two = _BALLS
        swapped = np.array(cases)
        swapped[:, one], swapped[:, two] = cases[:, two], cases[:, one]
        swapped[:, [2, 3]] = cases[:, [3, 2]]
        yield swapped, lambda got: np.concatenate([got[:, 6:], got[:, :6]], axis=1)


def asymmetry(judge: Judge, cases: Array) -> Array:
    """How far results of a case's images differ from its own, over what is allowed."""
    own = judge.run(cases)
    judge.evaluations += len(cases)
    worst = np.zeros(len(cases))
    for image, back in _images(judge, cases):
        got = judge.run(image)
        other = np.concatenate([back(got[:, :VELOCITIES]), got[:, VELOCITIES:]], axis=1)
        error = errors_of(cases, other, own).relative
        error = np.where(other[:, STATUS] == own[:, STATUS], error, np.inf)
        worst = np.maximum(worst, error)
    return worst / judge.allowed(cases)
