"""carom's objects as Python users expect them: types, pickles, copies, comparison, the stub."""

from __future__ import annotations

import copy
import enum
import pickle
import re
import subprocess
import sys
from pathlib import Path

import pytest

from generator import __version__
from tests.support.installed import carom, run, site
from tools.stubs import STUB, stub_of

CUE = [[0, 0, 0.028575], [0, 1.5, 0], [-52.5, 0, 0]]
BALL = [[0.02, 0.0535, 0.028575], [0, 0, 0], [0, 0, 0]]


def test_statuses_are_an_int_enum_and_the_version_is_the_generators() -> None:
    status = carom().Kernel().collide(carom().Parameters(), CUE, BALL)[2]
    assert status is carom().Status.OK and isinstance(status, enum.IntEnum) and status == 0
    assert carom().Kernel().collide(carom().Parameters(), BALL, CUE)[2] is carom().Status.OK
    apart = carom().Kernel().collide(carom().Parameters(), BALL, BALL)[2]
    assert apart is carom().Status.BAD_INPUT
    assert pickle.loads(pickle.dumps(apart)) is apart
    assert carom().__version__ == __version__


def test_parameters_compare_hash_copy_pickle_and_print_by_value() -> None:
    one, other = carom().Parameters(u_b=0.03, M1=0.2), carom().Parameters()
    for again in (copy.copy(one), copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
        assert again == one and hash(again) == hash(one) and again is not one
    assert one != other and one != "parameters" and len({one, other, copy.copy(one)}) == 2
    assert eval(repr(one), {"Parameters": carom().Parameters}) == one
    assert one.replace(u_b=0.05, M1=one.M) == other
    assert other.replace(M=0.2).M1 == 0.2
    with pytest.raises(AttributeError):
        one.u_b = 0.2
    with pytest.raises(TypeError, match="radius"):
        one.replace(radius=1)


def test_kernels_compare_hash_copy_pickle_and_print_by_what_was_asked() -> None:
    Kernel = carom().Kernel
    kernels = [Kernel(), Kernel(max_error=1e-3), Kernel("pooltool", steps=300), Kernel(steps=1000)]
    for kernel in kernels:
        for again in (copy.copy(kernel), copy.deepcopy(kernel), pickle.loads(pickle.dumps(kernel))):
            assert again == kernel and hash(again) == hash(kernel)
            assert (again.name, again.steps) == (kernel.name, kernel.steps)
        assert eval(repr(kernel), {"Kernel": Kernel}) == kernel
    assert len(set(kernels)) == 4 and kernels[0] != kernels[1] and kernels[0] != 1
    assert Kernel(max_error=2e-3) == kernels[1]  # the same kernel answers both


POOL = """
import sys
sys.path += sys.argv[1:]
import carom
from concurrent.futures import ProcessPoolExecutor
from functools import partial
import multiprocessing

def speed(kernel, parameters, v):
    cue = [[0, 0, 0.028575], [0, v, 0], [0, 0, 0]]
    ball = [[0.02, 0.0535, 0.028575], [0, 0, 0], [0, 0, 0]]
    return kernel.collide(parameters, cue, ball)

if __name__ == "__main__":
    work = partial(speed, carom.Kernel(max_error=1e-6), carom.Parameters(u_b=0.06))
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        there = list(pool.map(work, [1.0, 2.0, 3.0]))
    here = [work(v) for v in (1.0, 2.0, 3.0)]
    print(all((a[0] == b[0]).all() and a[2] is b[2] for a, b in zip(there, here)))
"""


def test_kernels_and_parameters_go_through_a_process_pool(tmp_path) -> None:
    script = tmp_path / "pool.py"
    script.write_text(POOL)
    libraries = [path for path in sys.path if path.endswith("site-packages")]
    assert run([sys.executable, script, site(), *libraries], timeout=900).strip() == "True"


# ---- what is installed -----------------------------------------------------------------------


def test_numpy_alone_is_needed_and_the_generator_is_an_extra() -> None:
    metadata = next(site().glob("carom-*.dist-info/METADATA")).read_text("utf-8")
    needs = re.findall(r"^Requires-Dist: (.*)$", metadata, re.MULTILINE)
    plain = [need for need in needs if "extra ==" not in need]
    print(f"{plain}; {len(needs) - len(plain)} for extras")
    assert [need.split(">")[0] for need in plain] == ["numpy"]
    assert any(need.startswith("sympy==") and "'gen'" in need.replace('"', "'") for need in needs)


def test_gen_without_its_packages_says_in_one_line_how_to_get_them() -> None:
    done = subprocess.run(
        [sys.executable, "-S", "-m", "carom_gen", "list", "targets"],
        env={"PYTHONPATH": str(site()), "PATH": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    print(done.stderr)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1
    assert "pip install 'carom[gen]'" in done.stderr


# ---- types ------------------------------------------------------------------------------------


def test_the_stub_is_what_nanobind_makes_of_the_module() -> None:
    assert stub_of(site()) == STUB.read_text("utf-8"), f"python tools/stubs.py {site()}"


def test_defaults_in_the_stub_are_those_of_the_module() -> None:
    text = STUB.read_text("utf-8")
    for name in ("R", "M", "u_s1", "u_s2", "u_b", "e_b"):
        assert f"{name}: float = {getattr(carom().Parameters(), name)!r}" in text


GOOD = """
import numpy as np

import carom
from carom.types import Array, Statuses

kernel = carom.Kernel("mathavan2014", max_error=1e-6)
parameters = carom.Parameters(R=0.03, u_b=np.float64(0.05)).replace(M=1)
cue = [[0, 0, 0.028575], [0, 1.5, 0], [-52.5, 0, 0]]
ball = np.zeros((3, 3))
after: Array
status: carom.Status
after, _, status = kernel.collide(parameters, cue, ball)
statuses: Statuses
out, statuses = kernel.collide_batch(parameters, np.zeros((18, 4)), u_b=0.05)
one, two, statuses = kernel.collide_batch(parameters, np.zeros((4, 3, 3)), np.zeros((4, 3, 3)))
rows, statuses = kernel.collide_batch(parameters, [[0.0] * 18] * 4, u_b=[0.1] * 4)
steps: int | None = kernel.steps
print(status.name, carom.__version__, carom.columns(one, two).shape, steps, out.shape, rows.shape)
"""

WRONG = """
import carom

kernel = carom.Kernel(max_eror=1e-6)
carom.Kernel("pooltool", steps="many")
parameters = carom.Parameters(R="big")
kernel.collide(parameters, "cue", [[0.0]])
kernel.collide({"R": 1}, [[0.0]], [[0.0]])
kernel.collide_batch(parameters, [[0.0]], u_b="high")
parameters.u_b = 0.2
after, status = kernel.collide(parameters, [[0.0]], [[0.0]])
"""


def _mypy(tmp_path: Path, text: str) -> str:
    script = tmp_path / "user.py"
    script.write_text(text)
    command = [sys.executable, "-m", "mypy", "--strict", "--no-incremental", "--config-file="]
    done = subprocess.run(
        [*command, str(script)],
        env={"MYPYPATH": str(site()), "PATH": ""},
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    print(done.stdout + done.stderr)
    return done.stdout


def test_mypy_strict_takes_a_right_script_and_names_each_wrong_line(tmp_path) -> None:
    assert "Success" in _mypy(tmp_path, GOOD)
    told = _mypy(tmp_path, WRONG)
    lines = {int(line.split(":")[1]) for line in told.splitlines() if ": error:" in line}
    assert lines == {4, 5, 6, 7, 8, 9, 10, 11}
