"""Every lane vocabulary does, lane by lane, what plain C++ does."""

import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest

from generator.emission import isa
from generator.emission.environment import environment
from generator.emission.lanes import LaneContext, lane_context
from generator.targets.host import read_host
from generator.targets.target import Target, target_or_port
from generator.toolchain.compilers import compilers_for, emulator_for, march_flags

PROGRAM = Path(__file__).parents[1] / "cpp" / "lanes_test.cpp"
FLAGS = ("-std=c++17", "-O1", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-ffp-contract=off")
# target, lanes of a vector, vectors interleaved
VOCABULARIES = (
    ("x86-64-v2", 1, 1),
    ("x86-64-v2", 2, 3),
    ("x86-64-v3", 4, 1),
    ("x86-64-v4", 2, 1),
    ("x86-64-v4", 4, 2),
    ("x86-64-v4", 8, 1),
    ("neoverse-n1", 2, 1),
    ("neoverse-n1", 2, 2),
    ("wasm32", 2, 1),
    ("wasm32", 2, 3),
)


def _vocabulary(target: str, lanes: LaneContext) -> str:
    """The text that a kernel includes; for one lane with what scalar kernels have elsewhere."""
    if lanes.width > 1:
        return environment().get_template(lanes.template).render(lanes=lanes)
    names = ("lanes/scalar.j2", "lanes/scalar_more.j2", "exact/scale.j2")
    estimate = isa.estimate(target_or_port(target), 0).scalar
    x = SimpleNamespace(real="double", table=True, lane_estimate=estimate)
    k = SimpleNamespace(places_fma=lanes.fma)
    parts = [environment().get_template(name).render(x=x, k=k) for name in names]
    return "\n".join(["constexpr std::uint64_t kExponentBits = 0x7ff0000000000000u;", *parts])


def _write(folder: Path, target: str, width: int, interleave: int) -> None:
    lanes = lane_context(target_or_port(target), width, interleave)
    begin, end = isa.pragmas(target_or_port(target), contract=False)
    facts = (
        f"constexpr double kEstimateError = {lanes.estimate_error!r};\n"
        f"constexpr bool kFused = {'true' if lanes.fma else 'false'};\n"
    )
    texts = {"begin": begin, "end": end, "facts": facts, "vocabulary": _vocabulary(target, lanes)}
    for name, text in texts.items():
        (folder / f"{name}.inc").write_text(text + "\n", "utf-8")


def _run(folder: Path, compile_with: list[str], run_with: list[str]) -> None:
    program = folder / "lanes_test"
    command = [*compile_with, *FLAGS, f"-I{folder}", str(PROGRAM), "-o", str(program)]
    built = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert built.returncode == 0, built.stderr[:2000]
    done = subprocess.run([*run_with, str(program)], capture_output=True, text=True, timeout=120)
    print(done.stdout)
    assert done.returncode == 0, done.stdout


def _compiled_for(target: Target) -> Target:
    """WebAssembly's vocabulary is Clang's vector extensions alone: this CPU's do the same."""
    return read_host().target if target.row.arch == "wasm32" else target


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(("target", "width", "interleave"), VOCABULARIES)
def test_vocabulary_does_in_every_lane_what_plain_cpp_does(
    tmp_path, compiler, target, width, interleave
):
    found = _compiled_for(target_or_port(target))
    runner = emulator_for(found)
    compilers = {c.code: c for c in compilers_for(found)}
    if compiler not in compilers or runner is None:
        pytest.skip(f"no {compiler} or no emulator for {found.row.arch}: apt-get install qemu-user")
    if target == "wasm32" and compiler == "gcc":
        pytest.skip("kernels for WebAssembly are Clang's alone")
    if not runner and not read_host().runs(found):
        pytest.skip(f"{target} code does not run on this CPU")
    _write(tmp_path, target, width, interleave)
    chosen = compilers[compiler]
    triple = [f for f in march_flags(chosen, found).flags if f.startswith("--target=")]
    _run(tmp_path, [chosen.path, *triple], list(runner))
