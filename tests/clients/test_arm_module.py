"""The Python module on AArch64: a wheel made by tools/wheels.py, run under qemu-user."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from generator.impacts.ball_ball.evidence.measure import errors_of
from tests.support.arm import arm_wheel, emulated_python, run_there
from tests.support.reference import load_reference

EVERY = 19  # the emulator is slow: of the reference cases every nineteenth
PROGRAM = """
import sys
import carom
import numpy as np
cases, out = np.load(sys.argv[1]), sys.argv[2]
kernel = carom.Kernel("mathavan2014", max_error=1e-6)
rows = []
for case in cases:
    given = carom.Parameters(*case[:6])
    one, two, status = kernel.collide(given, case[6:15].reshape(3, 3), case[15:].reshape(3, 3))
    batch, marks = kernel.collide_batch(given, case[6:].reshape(18, 1))
    rows.append([*one[1:].ravel(), *two[1:].ravel(), status, *batch[:, 0], marks[0]])
np.save(out, rows)
print(kernel.target, kernel.lanes, kernel)
try:
    carom.Parameters(u_b=2)
except ValueError as error:
    print(error)
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    emulated_python()  # skips where it cannot be had
    return arm_wheel(
        tmp_path_factory.mktemp("dist"),
        CAROM_KERNEL_MODELS="mathavan2014",
        CAROM_KERNEL_GOALS="e1m06",
    )


def test_a_manylinux_wheel_for_arm_keeps_its_budget_under_emulation(wheel, tmp_path) -> None:
    """By calls and in lanes of NEON."""
    reference = load_reference()
    cases, exact = reference.cases[::EVERY], reference.exact["mathavan2014"][::EVERY]
    np.save(tmp_path / "cases.npy", cases)
    told = run_there(
        wheel, tmp_path / "site", PROGRAM, tmp_path / "cases.npy", tmp_path / "out.npy"
    )
    print(f"{wheel.name}\n{told}")
    assert "manylinux" in wheel.name and wheel.name.endswith("_aarch64.whl")
    assert told.startswith("armv8 4 ") and "u_b = 2.0 is out of range: expected 0 to 1" in told
    rows = np.load(tmp_path / "out.npy")
    for way, got in (("calls", rows[:, :13]), ("batches", rows[:, 13:])):
        error = errors_of(cases, got, exact).relative
        print(f"{way}: {len(cases)} cases, largest error {error.max():.2g}")
        assert np.array_equal(got[:, 12], exact[:, 12])
        assert error.max() <= 1e-6
