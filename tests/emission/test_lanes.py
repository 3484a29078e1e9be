"""Every lane vocabulary does, lane by lane, what plain C++ does."""

import subprocess
from pathlib import Path
from unittest.mock import Mock

import pytest

from generator.emission.context import KernelContext
from generator.emission.environment import environment
from generator.impacts.ball_ball.steppers.exact.context import ExactContext
from generator.lowering import isa
from generator.lowering.lanes import LaneContext, lane_context
from generator.targets.host import read_host
from generator.targets.target import Target, target_or_port
from generator.toolchain.compilers import compilers_for, emulator_for, march_flags

PROGRAM = Path(__file__).parents[1] / "cpp" / "lanes_test.cpp"
FLAGS = ("-std=c++17", "-O1", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-ffp-contract=off")
# target, what a lane is, lanes of a vector, vectors interleaved
VOCABULARIES = (
    ("x86-64-v2", "double", 1, 1),
    ("x86-64-v2", "double", 2, 3),
    ("x86-64-v3", "double", 4, 1),
    ("x86-64-v4", "double", 2, 1),
    ("x86-64-v4", "double", 4, 2),
    ("x86-64-v4", "double", 8, 1),
    ("neoverse-n1", "double", 2, 1),
    ("neoverse-n1", "double", 2, 2),
    ("x86-64-v2", "float", 1, 1),
    ("x86-64-v2", "float", 4, 1),
    ("x86-64-v3", "float", 8, 2),
    ("x86-64-v4", "float", 4, 3),
    ("x86-64-v4", "float", 8, 1),
    ("x86-64-v4", "float", 16, 1),
    ("x86-64-v4", "float", 16, 4),
    ("neoverse-n1", "float", 4, 1),
    ("wasm32", "double", 2, 1),
    ("wasm32", "double", 2, 3),
    ("wasm32", "float", 4, 1),
)
# target, floats of a vector: the doubles of their frame
FRAMES = (("x86-64-v2", 4), ("x86-64-v3", 8), ("x86-64-v4", 16), ("neoverse-n1", 4), ("wasm32", 4))


def _vocabulary(target: str, lanes: LaneContext) -> str:
    """The text that a kernel includes; for one lane with what scalar kernels have elsewhere."""
    if lanes.width > 1:
        return environment().get_template(lanes.template).render(lanes=lanes)
    names = ("lanes/scalar.j2", "lanes/scalar_more.j2", "ball_ball/exact/scale.j2")
    real = lanes.number.real
    found = (isa.float_estimate if lanes.floats else isa.estimate)(target_or_port(target), 0)
    scales = {name: getattr(ExactContext, name) for name in ("slowest", "most_slip")}
    takes = {**scales, "takes_roots": True, "takes_powers": True, "table": True}
    x = Mock(spec=ExactContext, real=real, lane_estimate=found.scalar, **takes)
    k = Mock(spec=KernelContext, places_fma=lanes.fma)
    parts = [environment().get_template(name).render(x=x, k=k) for name in names]
    return "\n".join(["constexpr std::uint64_t kExponentBits = 0x7ff0000000000000u;", *parts])


def _write(folder: Path, target: str, lanes: LaneContext) -> None:
    begin, end = isa.pragmas(target_or_port(target), contract=False)
    facts = (
        f"constexpr double kEstimateError = {lanes.estimate_error!r};\n"
        f"constexpr bool kFused = {'true' if lanes.fma else 'false'};\n"
        f"#define CAROM_CONVERTS {int(lanes.converts)}\n"
    )
    texts = {"begin": begin, "end": end, "facts": facts, "vocabulary": _vocabulary(target, lanes)}
    for name, text in texts.items():
        (folder / f"{name}.inc").write_text(text + "\n", "utf-8")


def _run(folder: Path, compile_with: list[str], run_with: list[str]) -> None:
    program = folder / "lanes_test"
    command = [*compile_with, *FLAGS, f"-I{folder}", str(PROGRAM), "-o", str(program)]
    built = subprocess.run(command, capture_output=True, text=True, timeout=900)
    assert built.returncode == 0, built.stderr[:2000]
    done = subprocess.run([*run_with, str(program)], capture_output=True, text=True, timeout=900)
    print(done.stdout)
    assert done.returncode == 0, done.stdout


def _compiled_for(target: Target) -> Target:
    """WebAssembly's vocabulary is Clang's vector extensions alone: this CPU's do the same."""
    return read_host().target if target.row.arch == "wasm32" else target


def _hold(folder: Path, compiler: str, target: str, lanes: LaneContext) -> None:
    """Build the program for a vocabulary and run it; skipped where either cannot be done."""
    found = _compiled_for(target_or_port(target))
    runner = emulator_for(found)
    compilers = {c.code: c for c in compilers_for(found)}
    if compiler not in compilers or runner is None:
        pytest.skip(f"no {compiler} or no emulator for {found.row.arch}: apt-get install qemu-user")
    if target == "wasm32" and compiler == "gcc":
        pytest.skip("kernels for WebAssembly are Clang's alone")
    if not runner and not read_host().runs(found):
        pytest.skip(f"{target} code does not run on this CPU")
    _write(folder, target, lanes)
    chosen = compilers[compiler]
    triple = [f for f in march_flags(chosen, found).flags if f.startswith("--target=")]
    _run(folder, [chosen.path, *triple], list(runner))


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(("target", "precision", "width", "interleave"), VOCABULARIES)
def test_vocabulary_does_in_every_lane_what_plain_cpp_does(
    tmp_path, compiler, target, precision, width, interleave
):
    lanes = lane_context(target_or_port(target), width, interleave, precision=precision)
    _hold(tmp_path, compiler, target, lanes)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(("target", "width"), FRAMES)
def test_frame_of_floats_is_doubles_that_floats_are_loaded_into(tmp_path, compiler, target, width):
    frame = lane_context(target_or_port(target), width, precision="float").frame
    assert frame is not None and frame.width == width // 2
    _hold(tmp_path, compiler, target, frame)
