"""A vendored folder alone in an empty place: compilers, CPUs, threads, neighbours, headers."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

import generator.targets.target as target_room
from generator.registry.question import Goal
from generator.targets.target import Target, TargetRow, targets
from tests.support.hosts import skip_unless_runs
from tests.support.kernels import ROOT
from tests.support.vendored import EXACT, PAIRS, STRICT, compiled, ran, request_for, vendored

PROGRAMS = ROOT / "tests" / "vendor"
TARGETS = "zen3,x86-64-v2"
ALLOWED_CALLS = {
    *("memcpy", "memset", "memmove", "memcmp", "strcmp", "getenv"),
    *("sqrt", "fma", "fabs", "fmax", "fmin", "copysign", "floor", "exp", "hypot"),
    *("_GLOBAL_OFFSET_TABLE_", "__stack_chk_fail"),
}
pytestmark = pytest.mark.skipif(not PAIRS, reason="no C and C++ compiler of one make")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An exact kernel for two CPUs, copied alone to a place that knows nothing of carom."""
    made = vendored(tmp_path_factory.mktemp("made") / "carom", request_for(TARGETS))
    return Path(shutil.copytree(made, tmp_path_factory.mktemp("alone") / "carom"))


@pytest.fixture(scope="module")
def objects(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return compiled(folder, tmp_path_factory.mktemp("objects"), PAIRS[0][0], "-O1")


@pytest.fixture
def arm(monkeypatch: pytest.MonkeyPatch) -> str:
    """The first AArch64 target; one is made up where there is none."""
    known = targets()
    for name, target in known.items():
        if target.row.arch == "aarch64":
            return name
    row = TargetRow(
        text="made up",
        arch="aarch64",
        march="armv8-a",
        mca_cpu="cortex-a72",
        vector_bits=128,
        vector_registers=32,
    )
    features = frozenset({"neon", "fma"})
    made = Target(name="arm-made-up", row=row, features=features, ancestors=())
    monkeypatch.setattr(target_room, "targets", lambda: {**known, made.name: made})
    return made.name


def program(source: Path, objects: list[Path], folder: Path, into: Path, *flags: str) -> Path:
    """A client in C or C++ linked with units."""
    cxx, cc = PAIRS[0]
    is_c = source.suffix == ".c"
    compiler, standard = (cc, "-std=c99") if is_c else (cxx, "-std=c++17")
    made = into / source.stem
    ran([compiler, standard, *STRICT, *flags, f"-I{folder}", source, *objects, "-lm", "-o", made])
    return made


@pytest.mark.parametrize("pair", PAIRS, ids=[cxx for cxx, _ in PAIRS])
@pytest.mark.parametrize("level", ["-O0", "-O2"])
def test_builds_alone_as_c_and_cpp_and_passes_its_own_test(pair, level, tmp_path) -> None:
    """No flag but the warnings; linked as C, so nothing of C++'s library is needed either.

    As `gen vendor` makes it: for each CPU a unit for single calls and one in lanes.
    """
    cxx, cc = pair
    folder = vendored(tmp_path / "alone", request_for(TARGETS), lanes=True)
    objects = compiled(folder, tmp_path, cxx, level)
    for language, compiler, standard in (("c", cc, "c99"), ("c++", cxx, "c++17")):
        test = tmp_path / f"selftest-{standard}"
        source = ["-x", language, folder / "carom_selftest.c", "-x", "none"]
        ran([compiler, f"-std={standard}", *STRICT, level, *source, *objects, "-lm", "-o", test])
        told = ran([test]).stdout
        print(told)
        assert "2 kernels run, 0 failures" in told


@pytest.mark.parametrize("targets", [TARGETS, "x86-64-v2"])
def test_batches_go_through_the_kernel_that_was_chosen_for_them(targets, tmp_path) -> None:
    """A unit for single calls and one in lanes for each target; the self-test asks both."""
    made = vendored(tmp_path / "made", request_for(targets, Goal(steps=1000)), lanes=True)
    units = sorted(p.name for p in made.glob("*.cpp"))
    assert len(units) == 2 * len(targets.split(",")) + 1
    objects = compiled(made, tmp_path / "objects", PAIRS[0][0], "-O1")
    table = (made / "carom_dispatch.cpp").read_text("utf-8").split("kUnits[] = {")[1]
    for target in targets.split(","):
        symbol = f"carom_{target.replace('-', '_')}"
        assert f"{symbol}_collide," in table and f"{symbol}_batch_collide_batch," in table
        assert f"{symbol}_collide_batch," not in table
    test = tmp_path / "selftest"
    ran([PAIRS[0][1], "-std=c99", made / "carom_selftest.c", *objects, "-lm", "-o", test])
    told = ran([test]).stdout
    print(told)
    assert f"{len(targets.split(','))} kernels run, 0 failures" in told


@pytest.mark.skipif(shutil.which("nm") is None, reason="no nm")
@pytest.mark.parametrize("pair", PAIRS, ids=[cxx for cxx, _ in PAIRS])
@pytest.mark.parametrize(
    "goal", [EXACT, Goal(steps=1000)], ids=["exact in lanes", "steps in lanes"]
)
def test_units_share_no_code_hold_no_state_and_call_nothing_but_libm(pair, goal, tmp_path) -> None:
    """Not optimised, where every inline function would be a weak symbol that linkers may merge.

    What is called from outside shows that there are no exceptions, no allocation and no I/O.
    """
    made = vendored(tmp_path / "made", request_for(TARGETS, goal), lanes=True)
    state, called = [], set()
    for path in compiled(made, tmp_path / "objects", pair[0], "-O0"):
        for line in ran(["nm", "-C", path]).stdout.splitlines():
            kind, _, name = line.split(maxsplit=1)[-1].partition(" ")
            if line.split()[0] == "U":
                called.add(line.split()[1])
            if len(line.split()) < 3 or kind in "TtrR":
                continue
            assert kind in "db", f"{path.name}: {line}"
            state.append((path.stem, kind, name))
    written = [entry for entry in state if entry[1] == "b"]
    constants = {name.split("::")[-1] for _, kind, name in state if kind == "d"}
    foreign = {name for name in called if not name.startswith("carom_")}
    print(f"state: {written}; tables of pointers: {sorted(constants)}; calls {sorted(foreign)}")
    assert foreign <= ALLOWED_CALLS
    assert [(unit, name.split("::")[-1]) for unit, _, name in written] == [
        ("carom_dispatch", "chosen")
    ]
    assert constants <= {"kUnits", "kNone", "kKnown"}


def test_forcing_a_kernel_runs_that_kernel(folder, objects, tmp_path) -> None:
    """By function and by environment: name, and the very bits that its unit gives."""
    skip_unless_runs("zen3")
    run = program(PROGRAMS / "forced.c", objects, folder, tmp_path)
    lines = []
    for line in ran([run]).stdout.splitlines():
        print(line)
        target, *kernel, bits, same = line.split(" ")
        lines.append((target, " ".join(kernel), bits, same))
    forced = {target: (kernel, bits) for target, kernel, bits, _ in lines[1:]}
    assert list(forced) == ["zen3", "x86-64-v2"]
    for target, kernel, _, same_as_unit in lines[1:]:
        assert kernel.startswith(f"ball-ball/{target}/") and same_as_unit == "1"
    assert forced["zen3"][1] != forced["x86-64-v2"][1], "both round alike: this proves nothing"
    for target in forced:
        first = ran([run], env={"CAROM_TARGET": target}).stdout.splitlines()[0]
        assert first == " ".join([target, *forced[target], "0"])


def test_forcing_what_is_not_there_is_seen_in_every_status(folder, objects, tmp_path) -> None:
    run = program(PROGRAMS / "forced.c", objects, folder, tmp_path)
    first = ran([run], env={"CAROM_TARGET": "zen99"}).stdout.splitlines()[0].split()
    print(first)
    came = sum(0.3 + 0.01 * i for i in range(50)) + 50 * (1.5 - 20 + 3 + 12 + 0.02 + 0.0535)
    assert [*first[:2], first[3]] == ["none", "none", "4"]  # NO_KERNEL
    assert float.fromhex(first[2]) == pytest.approx(came, rel=1e-12)


@pytest.mark.skipif(shutil.which("qemu-x86_64") is None, reason="no qemu-x86_64")
@pytest.mark.parametrize(
    ("cpu", "chosen"),
    [("Nehalem", "x86-64-v2"), ("Haswell", "zen3"), ("EPYC-Rome", "zen3"), ("Conroe", "none")],
)
def test_the_cpu_decides(cpu, chosen, folder, objects, tmp_path) -> None:
    """On emulated CPUs: without AVX, with it, AMD's, and one that runs none of them."""
    run = program(PROGRAMS / "forced.c", objects, folder, tmp_path, "-static")
    told = ran(["qemu-x86_64", "-cpu", cpu, run]).stdout
    print(told)
    assert told.split()[0] == chosen
    assert ("zen3 cannot" in told) == (chosen != "zen3")


def test_first_calls_from_many_threads_do_not_race(folder, tmp_path) -> None:
    flags = ("-O1", "-fsanitize=thread")
    units = compiled(folder, tmp_path, PAIRS[0][0], *flags)
    run = program(PROGRAMS / "first_call.cpp", units, folder, tmp_path, *flags, "-pthread")
    told = ran([run])
    print(told.stdout, told.stderr)
    assert "threads agree" in told.stdout and "data race" not in told.stderr


def test_two_prefixes_live_in_one_program(tmp_path) -> None:
    """Both dispatched, both in one binary, both headers in one file."""
    skip_unless_runs("zen3")
    goals = {"fixed": Goal(steps=1000), "smooth": EXACT}
    objects = []
    for prefix, goal in goals.items():
        made = vendored(tmp_path / prefix, request_for(TARGETS, goal, prefix=prefix))
        objects += compiled(made, tmp_path / f"{prefix}-objects", PAIRS[0][0], "-O1")
    second = f"-I{tmp_path / 'smooth'}"
    run = program(PROGRAMS / "two_prefixes.cpp", objects, tmp_path / "fixed", tmp_path, second)
    told = ran(
        [run], env={"FIXED_TARGET": "x86-64-v2", "SMOOTH_TARGET": "zen3"}
    ).stdout.splitlines()
    print(told)
    assert told[0].startswith("ball-ball/x86-64-v2/any/mathavan2014-n1000-x1 fixed ")
    assert told[1].startswith("ball-ball/zen3/any/mathavan2014-e1m06-x1 dp54 ")


def test_typed_header_collides_one_and_many(folder, objects, tmp_path) -> None:
    told = ran([program(PROGRAMS / "typed.cpp", objects, folder, tmp_path)]).stdout
    print(told)
    assert told == "6 of 7 collided\n"


@pytest.mark.parametrize("pair", PAIRS, ids=[cxx for cxx, _ in PAIRS])
@pytest.mark.parametrize("targets", [TARGETS, "x86-64-v2"])
def test_one_header_holds_everything(pair, targets, tmp_path) -> None:
    """Its self-test, a C99 client, and two such headers implemented in one file."""
    cxx, cc = pair
    for prefix, goal in {"carom": EXACT, "fixed": Goal(steps=200)}.items():
        request = request_for(targets, goal, prefix=prefix, single_header=True)
        made = vendored(tmp_path / prefix, request)
        test = tmp_path / f"{prefix}-test"
        ran([cxx, "-std=c++17", *STRICT, made / f"{prefix}_selftest.cpp", "-lm", "-o", test])
        told = ran([test]).stdout
        print(told)
        assert "0 failures" in told
    both = tmp_path / "both.cpp"
    lines = [f'#define {p}_IMPLEMENTATION\n#include "{p.lower()}.h"' for p in ("CAROM", "FIXED")]
    both.write_text("\n".join(lines) + "\n")
    includes = [f"-I{tmp_path / prefix}" for prefix in ("carom", "fixed")]
    ran([cxx, "-std=c++17", *STRICT, *includes, "-c", both, "-o", tmp_path / "both.o"])
    client = ROOT / "tests" / "c" / "one_collision.c"
    run = tmp_path / "run"
    ran([cc, "-std=c99", *STRICT, *includes, client, tmp_path / "both.o", "-lm", "-o", run])
    assert "status 0" in ran([run]).stdout


@pytest.mark.skipif(
    not (shutil.which("aarch64-linux-gnu-g++") and shutil.which("qemu-aarch64")),
    reason="no AArch64 cross compiler or no qemu-aarch64",
)
@pytest.mark.parametrize("names", ["x86-64-v2,ARM", "ARM"])
def test_other_architectures_build_and_run_from_the_same_folder(names, tmp_path, arm) -> None:
    """x86-64 and AArch64 in one folder: each compiler takes its own units; qemu runs AArch64."""
    made = vendored(tmp_path / "made", request_for(names.replace("ARM", arm)))
    compilers = {"aarch64-linux-gnu-g++": ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"]}
    if names != "ARM":
        compilers[PAIRS[0][0]] = []
    for compiler, runner in compilers.items():
        objects = compiled(made, tmp_path / compiler, compiler, "-O1")
        test = tmp_path / f"{compiler}-selftest"
        source = ["-x", "c++", made / "carom_selftest.c", "-x", "none"]
        ran([compiler, "-std=c++17", *STRICT, *source, *objects, "-lm", "-o", test])
        told = ran([*runner, test]).stdout
        print(told)
        assert "0 failures" in told and "33 cases" in told
        assert (arm in told) == bool(runner)


def test_the_typed_header_says_that_it_needs_cpp17(folder: Path, tmp_path: Path) -> None:
    """In the first line that a compiler prints; carom.h serves an older standard."""
    program_14 = tmp_path / "old.cpp"
    compiler = shutil.which("clang++-14") or PAIRS[0][0]
    command = [compiler, "-std=c++14", "-fsyntax-only", "-I", folder, program_14]
    program_14.write_text('#include "carom.h"\nint main() { return CAROM_OK; }\n')
    ran(command)
    program_14.write_text('#include "carom.hpp"\nint main() {}\n')
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    first = next(line for line in done.stderr.splitlines() if "error" in line)
    print(first)
    assert done.returncode and "carom.hpp needs C++17: compile with -std=c++17" in first


@pytest.mark.parametrize("other", ["-U__x86_64__", "-U__GNUC__"])
def test_another_architecture_or_compiler_is_refused_in_one_line(tmp_path, other: str) -> None:
    """As the preprocessor of such a compiler sees a kernel: what it is for, first of all."""
    alone = vendored(tmp_path / "carom", request_for("x86-64-v2"))
    kernel = next(alone.glob("carom_x86*.cpp"))
    command = [PAIRS[0][0], "-std=c++17", "-fsyntax-only", other, "-I", alone, kernel]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    first = next(line for line in done.stderr.splitlines() if "error" in line)
    print(first)
    assert done.returncode and "This is for x86-64, and for GCC or Clang" in first


@pytest.mark.parametrize("way", ["add_subdirectory", "find_package"])
def test_cmake_carries_cpp17_to_cpp_consumers_and_asks_c_ones_for_nothing(
    folder: Path, tmp_path: Path, way: str
) -> None:
    """The standard of a program that names none, whatever its compiler takes by default."""
    if way == "find_package":
        build = tmp_path / "carom"
        ran(["cmake", "-S", folder, "-B", build, "-DCAROM_BUILD_SELFTEST=OFF"])
        ran(["cmake", "--build", build])
        ran(["cmake", "--install", build, "--prefix", tmp_path / "place"])
        found = f'find_package(carom REQUIRED PATHS "{tmp_path / "place"}")'
    else:
        found = f'add_subdirectory("{folder}" carom)'
    for language, suffix, include in (("C", "c", "carom.h"), ("CXX", "cpp", "carom.hpp")):
        source = tmp_path / f"{way}-{language}"
        source.mkdir()
        (source / f"main.{suffix}").write_text(
            f'#include "{include}"\nint main(void) {{ return 0; }}\n'
        )
        lines = [
            "cmake_minimum_required(VERSION 3.16)",
            f"project(app {language})",
            found,
            f"add_executable(app main.{suffix})",
            "target_link_libraries(app PRIVATE carom::carom)",
            "get_target_property(asked carom::carom INTERFACE_COMPILE_FEATURES)",
            'message(STATUS "asked: ${asked}")',
        ]
        (source / "CMakeLists.txt").write_text("\n".join(lines) + "\n")
        told = ran(["cmake", "-S", source, "-B", source / "build"]).stdout
        asked = next(line for line in told.splitlines() if "asked: " in line)
        print(f"{way}, {language}: {asked}")
        assert ("cxx_std_17" in asked) == (language == "CXX")
        ran(["cmake", "--build", source / "build", "--target", "app"])
