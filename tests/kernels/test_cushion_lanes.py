"""Batches of the cushion in lanes: errors, and that neighbours do not count."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from generator.emission.kernel_source import emit
from generator.errors import KernelError
from generator.impacts.ball_cushion.evidence import EVIDENCE
from generator.registry.variant import Variant
from tests.support.cushion import (
    CushionFunction,
    cushion_variant,
    errors,
    load_cases,
    load_outcomes,
)
from tests.support.kernels import build_all

CASES = load_cases()
SHARED = [EVIDENCE.shared[name] for name in ("R", "M", "u_s")]
TARGETS = {"x86-64-v2": 2, "x86-64-v3": 4, "armv8": 2, "x86-64-v4": 8}


def lanes(
    budget: float, model: str = "clamped", target: str = "x86-64-v3", **options: str
) -> Variant:
    fma = "nofma" if target == "x86-64-v2" else "fma"
    single = cushion_variant(
        model=model, budget=budget, stepper="series", target=target, fma=fma, **options
    )
    return single.in_lanes(TARGETS[target])


@cache
def kernel(
    budget: float, model: str = "clamped", compiler: str = "gcc", target: str = "x86-64-v3"
) -> CushionFunction:
    library = build_all([lanes(budget, model, target, compiler=compiler)])[0]
    if isinstance(library, KernelError):
        raise library
    return CushionFunction(library.path)


def one_by_one(function: CushionFunction, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Batches of one, since the cases differ in what a batch shares."""
    done = [function.batch(row[:6], row[None, 6:]) for row in rows]
    return np.concatenate([d[0] for d in done]), np.concatenate([d[1] for d in done])


def shared_rows() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All cases with the parameters of a pool table, and friction of each at the cushion."""
    table = np.array([*SHARED, 0.2, EVIDENCE.shared["e_c"], EVIDENCE.shared["h"]])
    return table, CASES.rows[:, 6:], np.minimum(CASES.rows[:, 3], 0.45)


@pytest.mark.parametrize(
    ("budget", "model", "compiler"),
    [
        (1e-3, "clamped", "gcc"),
        (1e-6, "clamped", "gcc"),
        (1e-6, "clamped", "clang"),
        (1e-6, "printed", "gcc"),
        (1e-9, "clamped", "clang"),
    ],
)
def test_lanes_keep_to_the_budget(budget: float, model: str, compiler: str) -> None:
    exact = load_outcomes("exact.csv", CASES.ids)
    if model == "printed":
        printed = load_outcomes("exact_printed.csv", CASES.ids)
        exact = np.where(np.isnan(printed), exact, printed)
    found, status = one_by_one(kernel(budget, model, compiler), CASES.rows)
    off = errors(found, exact, CASES) / budget
    worst = int(np.argmax(off))
    print(f"{model} {budget:g}: {off[worst]:.3g} of it,", CASES.kinds[worst], CASES.ids[worst])
    assert (status == 0).all()
    assert off.max() <= 1


def test_what_an_impact_comes_to_does_not_depend_on_its_neighbours() -> None:
    table, motion, u_w = shared_rows()
    whole, status, good = kernel(1e-6).batch(table, motion, u_w)
    assert (status == 0).all()
    assert good == len(motion)
    order = np.random.default_rng(3).permutation(len(motion))
    mixed, _, _ = kernel(1e-6).batch(table, motion[order], u_w[order])
    assert np.array_equal(mixed, whole[order])
    for n in (1, 2, 3, 5, 31, 33):
        part, _, _ = kernel(1e-6).batch(table, motion[:n], u_w[:n])
        assert np.array_equal(part, whole[:n])


def test_lanes_give_what_calls_give_to_the_budget_and_the_same_statuses() -> None:
    table, motion, u_w = shared_rows()
    motion = motion.copy()
    motion[::7, :2] *= -1  # some leave
    motion[::11, 3] = np.nan
    u_w = u_w.copy()
    u_w[::13] = -1.0
    rows = np.column_stack([np.tile(table, (len(motion), 1)), motion])
    rows[:, 3] = u_w
    called, statuses = kernel(1e-6)(rows)
    batch, status, good = kernel(1e-6).batch(table, motion, u_w)
    assert np.array_equal(status, statuses)
    assert set(status) == {0, 1, 2}
    assert good == (status == 0).sum()
    kept = status != 0
    assert np.array_equal(batch[kept], motion[kept, :6], equal_nan=True)
    speed = np.linalg.norm(motion[:, :2], axis=1)
    off = np.abs(batch - called)[~kept] * [1, 1, 1, *[table[0]] * 3] / speed[~kept, None]
    print(f"largest difference {off.max():.2g} of the speed")
    assert off.max() <= 1e-6


def test_in_lanes_energy_never_grows_and_images_end_as_images() -> None:
    table, motion, u_w = shared_rows()
    found, _, _ = kernel(1e-6).batch(table, motion, u_w)
    inertia = 0.4 * table[0] ** 2
    energy = [
        (v[:, :3] ** 2).sum(axis=1) + inertia * (v[:, 3:6] ** 2).sum(axis=1)
        for v in (motion, found)
    ]
    growth = (energy[1] / energy[0] - 1).max()
    print(f"largest relative growth {growth:.2g}")
    assert growth <= 1e-6
    mirrored = motion * [-1, 1, 1, 1, -1, -1, -1, 1]
    other, _, _ = kernel(1e-6).batch(table, mirrored, u_w)
    assert np.abs(other - found * [-1, 1, 1, 1, -1, -1]).max() < 1e-12
    for factor in (2.0**-600, 2.0**40):
        scaled = motion * [*[factor] * 6, 1, 1]
        other, _, _ = kernel(1e-6).batch(table, scaled, u_w)
        assert np.array_equal(other / factor, found)


@pytest.mark.parametrize("target", TARGETS)
def test_every_instruction_set_has_a_text(target: str) -> None:
    assert "step_lanes<true>" in emit(lanes(1e-6, target=target), laid_out=False).source


def test_steps_of_other_kinds_have_no_lanes() -> None:
    with pytest.raises(ValueError, match="lanes-of-series-alone"):
        emit(cushion_variant(budget=1e-6, stepper="dp54").in_lanes(4))
    with pytest.raises(ValueError, match="lanes-of-series-alone"):
        emit(cushion_variant(model="pooltool", steps=1000).in_lanes(4))
