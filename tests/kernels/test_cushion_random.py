"""Exact kernels of the cushion on random impacts, hard kinds among them, by a tighter budget."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kernels.test_cushion_exact import kernel
from tests.support.cushion import CushionCases, errors

COUNT = 4000


def random_cases(seed: int, count: int) -> CushionCases:
    """The envelope of real use and beyond: slips near zero, straight shots, noses near the jam."""
    rng = np.random.default_rng(seed)
    rows = np.zeros((count, 14))
    radius = rng.uniform(0.025, 0.035, count)
    height = radius * np.where(rng.random(count) < 0.8, rng.uniform(1, 1.45, count), 1.6)
    rows[:, 0], rows[:, 1], rows[:, 5] = radius, rng.uniform(0.13, 0.3, count), height
    rows[:, 2] = np.where(rng.random(count) < 0.9, rng.uniform(0, 0.5, count), 0.8)
    rows[:, 3] = rng.uniform(0, 0.5, count) * np.where(rng.random(count) < 0.8, 0.6, 1)
    rows[:, 4] = np.where(rng.random(count) < 0.05, 0, rng.uniform(0.5, 1, count))
    speed = 10 ** rng.uniform(-2, 1.1, count)
    angle = rng.uniform(-1, 1, count) * np.pi / 2 * 0.9999 * (rng.random(count) < 0.9)
    v = speed[:, None] * np.column_stack([np.sin(angle), np.cos(angle)])
    spin = np.column_stack([-v[:, 1], v[:, 0], np.zeros(count)])  # of rolling
    kind = rng.integers(0, 5, count)
    spin *= np.where(kind == 1, 0, np.where(kind == 2, rng.uniform(-1, 1, count), 1))[:, None]
    spin[kind == 3] = rng.uniform(-20, 20, (int((kind == 3).sum()), 3))
    near = 10 ** rng.uniform(-12, -1, count) * speed * (kind == 4)
    spin += near[:, None] * rng.uniform(-1, 1, (count, 3))
    spin[:, 2] += speed * rng.uniform(-2, 2, count) * (rng.random(count) < 0.3)
    rows[:, 6:8], rows[:, 9:12] = v, spin / radius[:, None]
    rows[:, 13] = 1
    sine = height / radius - 1
    jams = np.arcsin(sine) + np.arctan(rows[:, 2]) + np.arctan(rows[:, 3]) > np.pi / 2 - 1e-4
    rows = rows[~jams]
    return CushionCases(tuple(map(str, range(len(rows)))), ("random",) * len(rows), rows)


@pytest.mark.parametrize(("budget", "finer"), [(1e-3, 1e-6), (1e-6, 1e-9), (1e-9, 1e-11)])
def test_random_impacts_keep_to_the_budget(budget: float, finer: float) -> None:
    cases = random_cases(2010, COUNT)
    found, status = kernel("clamped", budget)(cases.rows)
    want, _ = kernel("clamped", finer)(cases.rows)
    off = errors(found, want, cases) / budget
    worst = int(np.argmax(off))
    print(
        f"{len(cases.rows)} impacts, {budget:g}: {off[worst]:.3g} of it", cases.rows[worst].tolist()
    )
    assert (status == 0).all()
    assert off.max() <= 1
