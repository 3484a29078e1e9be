"""What a host program may be: threads with small stacks, floating-point exceptions unmasked."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

import tests.kernels.test_degenerate as test_degenerate
from generator.emission.kernel_source import emit
from generator.evidence.timing.bench_tool import ROOT
from generator.registry.rules import broken_rule
from generator.registry.stack import MOST_UNOPTIMISED, unoptimised_stack
from generator.registry.variant import Stepper, Variant, make_variant
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.compilers import find_compilers
from tests.kernels.test_batches import EXACT, FLOATS, KERNELS, _built, _mathavan
from tests.support.exact_kernels import load_hard
from tests.support.kernels import bench_tool
from tests.support.reference import load_reference

MOST_STACK = {"-O3": 32 << 10, "-O0": MOST_UNOPTIMISED}  # bytes of a function: carom.h promises it
MOST_OF_A_BATCH = 112 << 10  # and this
WIDE = {"interleave": "i2", "root": "est1", "fma": "fma"}
WIDEST = (  # the most numbers in flight of each kind
    KERNELS[3],
    EXACT[3],
    ("x86-64-v4", 8, "ss43", 1e-4, WIDE),
    EXACT[5],
    EXACT[7],
    EXACT[10],
    EXACT[14],
    EXACT[0],  # and the fewest
)
RUNNABLE = (KERNELS[0], KERNELS[3], *EXACT[2:4], *EXACT[6:], FLOATS[2])
KINDS = ("v_n zero", "v_n tiny", "v_n positive", "tilted", "hardly tilted", "vertical", "gap")


def _name(kernel: tuple) -> str:
    return f"{kernel[0]}-x{kernel[1]}-{kernel[2]}" if len(kernel) > 3 else f"{kernel[0]}-fixed"


@pytest.mark.parametrize("level", MOST_STACK)
@pytest.mark.parametrize("kernel", WIDEST, ids=_name)
def test_no_function_takes_much_of_the_stack(kernel, level, tmp_path: Path) -> None:
    source = emit(_mathavan(kernel))
    (tmp_path / "carom.h").write_text(source.header, "utf-8")
    (tmp_path / "kernel.cpp").write_text(source.source, "utf-8")
    for compiler in find_compilers():
        if compiler.code not in ("gcc", "clang"):
            continue
        flags = ["-std=c++17", level, "-fstack-usage", "-c", "kernel.cpp"]
        subprocess.run([compiler.path, *flags], cwd=tmp_path, check=True, timeout=900)
        lines = (tmp_path / "kernel.su").read_text("utf-8").splitlines()
        most = max(int(line.split("\t")[1]) for line in lines)
        print(f"{compiler.code} {level}: at most {most} bytes in a function")
        assert most <= MOST_STACK[level]


def _cases() -> np.ndarray:
    rng = np.random.default_rng(5)
    kinds = [test_degenerate.KINDS[kind](rng, 40, "mathavan2014")[0] for kind in KINDS]
    drawn = bench_tool().make_cases(4, 400, mixed=False).rows
    return np.vstack([load_reference().cases, load_hard()[1], drawn, *kinds])


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory):
    folder = tmp_path_factory.mktemp("host")
    names = ("raised_flags", "small_stack")
    for name in names:
        source = ROOT / "tests" / "cpp" / f"{name}.cpp"
        flags = ["-std=c++17", "-O2", "-Wall", "-Wextra", "-Werror", "-pthread"]
        command = ["g++", *flags, source, "-o", folder / name, "-ldl"]
        subprocess.run(command, check=True, timeout=900)
    rows = _cases()
    rows.tofile(folder / "rows.bin")

    def run(name: str, library: Path, *words: str) -> str:
        command = [folder / name, library, folder / "rows.bin", str(len(rows)), *words]
        done = subprocess.run(command, capture_output=True, text=True, timeout=900)
        print(done.stdout)
        assert done.returncode == 0, f"status {done.returncode}\n{done.stdout[-2000:]}"
        return done.stdout

    return run


FLOATS_IN_AVX2 = ("x86-64-v3", 8, "dp54", 1e-6, EXACT[7][4])


@pytest.mark.parametrize("kernel", (KERNELS[0], FLOATS_IN_AVX2, EXACT[9]), ids=_name)
def test_clang_makes_no_division_that_a_mask_or_a_branch_leaves_out(kernel, program) -> None:
    if not any(compiler.code == "clang" for compiler in find_compilers()):
        pytest.skip("no Clang here")
    if not read_host().runs(find_target(kernel[0])):
        pytest.skip(f"{kernel[0]} code does not run on this CPU")
    library = _built(_mathavan(kernel).with_options(compiler="clang")).path
    assert "0 calls and 0 batches raise" in program("raised_flags", library)
    program("raised_flags", library, "trap")


def _library(kernel: tuple) -> Path:
    if not read_host().runs(find_target(kernel[0])):
        pytest.skip(f"{kernel[0]} code does not run on this CPU")
    return _built(_mathavan(kernel)).path


@pytest.mark.parametrize("kernel", RUNNABLE, ids=_name)
def test_nothing_but_inexact_and_underflow_is_raised(kernel, program) -> None:
    """By calls and batches, full and with a tail; then with the others unmasked."""
    library = _library(kernel)
    assert "0 calls and 0 batches raise" in program("raised_flags", library)
    program("raised_flags", library, "trap")


@pytest.mark.parametrize("kernel", RUNNABLE, ids=_name)
def test_a_thread_of_128_kib_runs_batches(kernel, program) -> None:
    said = program("small_stack", _library(kernel))
    took = [int(n) for n in re.findall(r"took (\d+) bytes", said)]
    assert len(took) == 2 and max(took) < MOST_OF_A_BATCH


def test_lanes_that_would_not_fit_the_stack_are_refused_by_name() -> None:
    target = find_target("x86-64-v4")

    def of(tableau: str, way: str) -> Variant:
        stepper = Stepper(tableau, budget=1e-6)
        return make_variant("x86-64-v4", "any", "mathavan2014", stepper, 8, interleave=way)

    for tableau, way in (("dop853", "i1"), ("dop853", "i2"), ("dp54", "i2"), ("ss43", "i4")):
        broken = broken_rule(of(tableau, way), target)
        print(f"{tableau} {way}: up to {unoptimised_stack(of(tableau, way))} bytes unoptimised")
        assert broken is not None and broken.name == "lanes-fit-the-stack"
    for tableau, way in (("dop853", "s2"), ("dp87", "i1"), ("dp54", "i1"), ("ss43", "i2")):
        assert broken_rule(of(tableau, way), target) is None
