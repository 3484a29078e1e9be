"""AArch64: kernels are cross-compiled and run under qemu-user. Of time nothing is said."""

import subprocess

import numpy as np
import pytest
from kernels import CACHE, EULER, ROOT, bench_tool

from generator.emission.kernel_source import emit
from generator.targets.target import find_target
from generator.toolchain.build import BuildJob, build
from generator.toolchain.compilers import compilers_for, emulator_for
from generator.toolchain.flags import compile_flags
from generator.variants.variant import Stepper, make_variant
from generator.verification.euler import euler_verdict
from generator.verification.exact import exact_verdict
from generator.verification.reference import load_reference

TARGET = find_target("neoverse-n1")
RUNNER = ("bench/run.cpp", "bench/batch.cpp", "bench/case_rows.cpp", "bench/kernel_library.cpp")
COMPILERS = {c.code: c for c in compilers_for(TARGET)}
EMULATOR = emulator_for(TARGET)
EVERY = 7  # the emulator is slow: of the reference cases every seventh
FIXED = {"state": "reduced", "reuse": "factored", "roots": "early", "branch": "chosen"}
LANES = {"interleave": "i2", "lane_root": "est2"}
KERNELS = {
    "fixed steps": (1, EULER, {**FIXED, "rsqrt": "ahead", "fma": "fma"}),
    "batches": (2, EULER, {**FIXED, "rsqrt": "inv", "fma": "fma", "finished": "aside", **LANES}),
    "exact": (1, Stepper("dp54", budget=1e-6), {"root": "est2", "fma": "fma"}),
}

pytestmark = pytest.mark.skipif(
    not COMPILERS or EMULATOR is None,
    reason="no cross compiler or no emulator: apt-get install g++-aarch64-linux-gnu qemu-user",
)


@pytest.fixture(scope="module")
def runner(tmp_path_factory):
    """Runs a library on rows of cases, under the emulator."""
    folder = tmp_path_factory.mktemp("aarch64")
    program = folder / "run_rows"
    sources = [str(ROOT / name) for name in ("tests/cpp/run_rows.cpp", *RUNNER)]
    command = [COMPILERS["gcc"].path, "-std=c++17", "-O1", f"-I{ROOT / 'bench'}", *sources]
    subprocess.run([*command, "-ldl", "-o", str(program)], check=True, timeout=120)

    def run(library, rows, batch):
        cases, out = folder / "cases", folder / "out"
        np.ascontiguousarray(rows).tofile(cases)
        words = [*EMULATOR, str(program), str(library), str(cases), str(out)]
        subprocess.run([*words, *["--batch"] * batch], check=True, timeout=300)
        return np.fromfile(out).reshape(len(rows), 13)

    return run


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("name", KERNELS)
def test_kernels_are_right_under_emulation(runner, name, compiler):
    if compiler not in COMPILERS:
        pytest.skip(f"no {compiler}")
    width, stepper, options = KERNELS[name]
    made = make_variant(
        TARGET.name, "any", "mathavan2014", stepper, width, **{**options, "compiler": compiler}
    )
    source, chosen = emit(made), COMPILERS[compiler]
    texts = {"carom.h": source.header, "kernel.cpp": source.source, "probe.cpp": source.probe}
    flags = (*compile_flags(made, chosen, TARGET), "-Wall", "-Wextra", "-Werror")
    library = build(BuildJob(name, texts, chosen, flags), CACHE)
    reference = load_reference()
    rows, exact = reference.cases[::EVERY], reference.exact["mathavan2014"][::EVERY]
    got = runner(library.path, rows, width > 1)
    if stepper.steps is None:
        verdict = exact_verdict(rows, got, exact, stepper.budget)
        error = f"{verdict.max_rel_error:.2g} of the relative speed"
    else:
        euler = bench_tool().expect(rows, "euler", "mathavan2014")
        verdict = euler_verdict(rows, got, euler, exact, stepper.steps, 0.02)
        error = f"{verdict.max_abs_error:.2g} m/s"
    print(f"{TARGET.name}, {name}, {compiler}: {len(rows)} cases, {error}; {verdict.reason}")
    assert verdict.passed, verdict.reason
