"""pooltool's fixed steps of the cushion, as kernels of ours: to its last digits."""

from __future__ import annotations

import numpy as np
import pytest

from generator.errors import KernelError
from tests.support.cushion import (
    CushionFunction,
    cushion_variant,
    errors,
    load_cases,
    load_outcomes,
    sizes,
)
from tests.support.kernels import build_all

CASES = load_cases()
SAME = 1e-9  # of the largest speed before
# A slip that is zero but for rounding decides which way the first step pushes: none here.
MOST_FLIPS = 12


def built(compiler: str = "gcc", **asked: object) -> CushionFunction:
    library = build_all([cushion_variant(compiler=compiler, **asked)])[0]
    if isinstance(library, KernelError):
        raise library
    return CushionFunction(library.path)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(("steps", "file"), [(1000, "pooltool.csv"), (5000, "pooltool_fine.csv")])
def test_the_scheme_gives_what_pooltool_gives(compiler: str, steps: int, file: str) -> None:
    got, status = built(compiler, model="pooltool", steps=1000)(CASES.rows, steps=steps)
    want = load_outcomes(file, CASES.ids)
    scale = sizes(CASES.before, CASES.radii)
    off = np.abs((got - want) * [1, 1, 1, *[0.03] * 3]).max(axis=1) / scale
    flips = [f"{CASES.ids[i]} {CASES.kinds[i]} {off[i]:.1e}" for i in np.flatnonzero(off > SAME)]
    print(
        f"{file}: largest {off[off <= SAME].max():.2g} but for {len(flips)} flips:",
        *flips,
        sep="\n",
    )
    assert (status == 0).all()
    assert len(flips) <= MOST_FLIPS
    exact = load_outcomes("exact.csv", CASES.ids)
    print("median error against the exact result", np.median(errors(got, exact, CASES)))


def test_steps_of_a_table_that_only_pushes_come_to_the_exact_result() -> None:
    """First order: ten times the steps, a tenth of the median error."""
    exact = load_outcomes("exact.csv", CASES.ids)
    fast = np.linalg.norm(CASES.before[:, :2], axis=1) > 2.0  # no step is the shortest there
    found = {}
    for steps in (1000, 10000):
        got, _ = built(model="clamped", steps=1000)(CASES.rows, steps=steps)
        found[steps] = float(np.median(errors(got, exact, CASES)[fast]))
    print(found)
    assert found[10000] < 0.2 * found[1000]
