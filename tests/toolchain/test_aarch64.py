"""AArch64: kernels are cross-compiled and run under qemu-user. Of time nothing is said."""

import numpy as np
import pytest

from generator.choice import seeds
from generator.choice.entries import selected
from generator.choice.job import Held, hold, hold_batches
from generator.choice.kernel import Estimated
from generator.choice.workbench import Workbench
from generator.emission.kernel_source import emit
from generator.evidence.timing.bench_tool import Way
from generator.evidence.timing.emulated import EmulatedRunner, emulated_runner
from generator.impacts.ball_ball.evidence.fixed_steps import euler_verdict
from generator.registry.question import Contest, Goal
from generator.registry.variant import Stepper, Variant, make_variant
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.build import BuildJob, build
from generator.toolchain.compilers import compilers_for, emulator_for
from generator.toolchain.flags import compile_flags
from generator.toolchain.mca import find_mca
from generator.toolchain.traces import instrumented, traced
from tests.support.kernels import CACHE, EULER, bench_tool
from tests.support.reference import exact_verdict, load_reference

TARGET = find_target("neoverse-n1")
COMPILERS = {c.code: c for c in compilers_for(TARGET)}
EMULATOR = emulator_for(TARGET)
EVERY = 7  # the emulator is slow: of the reference cases every seventh
FIXED = {"state": "reduced", "reuse": "factored", "roots": "early", "branch": "chosen"}
LANES = {"interleave": "i2", "lane_root": "est2"}
EXACT, ARCADE = Stepper("dp54", budget=1e-6), Stepper("ss43", budget=1e-3)
KERNELS = {  # scene, lanes, stepper, options
    "fixed steps": ("any", 1, EULER, {**FIXED, "rsqrt": "ahead", "fma": "fma"}),
    "batches": (
        "any",
        2,
        EULER,
        {**FIXED, "rsqrt": "inv", "fma": "fma", "finished": "aside", **LANES},
    ),
    "exact": ("any", 1, EXACT, {"root": "est2", "fma": "fma"}),
    "floats": ("arcade", 4, ARCADE, {"root": "est1", "fma": "fma", "interleave": "i1"}),
}

pytestmark = pytest.mark.skipif(
    not COMPILERS or EMULATOR is None,
    reason="no cross compiler or no emulator: apt-get install g++-aarch64-linux-gnu qemu-user",
)


@pytest.fixture(scope="module")
def runner() -> EmulatedRunner:
    """Runs a library on rows of cases, under the emulator."""
    return emulated_runner(TARGET, CACHE)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("name", KERNELS)
def test_kernels_are_right_under_emulation(runner, name, compiler):
    if compiler not in COMPILERS:
        pytest.skip(f"no {compiler}")
    scene, width, stepper, options = KERNELS[name]
    made = make_variant(
        TARGET.name, scene, "mathavan2014", stepper, width, **{**options, "compiler": compiler}
    )
    source, chosen = emit(made), COMPILERS[compiler]
    texts = {"carom.h": source.header, "kernel.cpp": source.source, "probe.cpp": source.probe}
    flags = (*compile_flags(made, chosen, TARGET), "-Wall", "-Wextra", "-Werror")
    library = build(BuildJob(name, texts, chosen, flags), CACHE)
    reference = load_reference()
    rows, exact = reference.cases[::EVERY], reference.exact["mathavan2014"][::EVERY]
    if scene == "arcade":  # the same table for both balls
        rows = rows.copy()
        rows[:, 3] = rows[:, 2]
        exact = bench_tool().expect(rows, "exact", "mathavan2014")
    got = runner.run_kernel(library.path, rows, batch=width > 1)
    if stepper.steps is None:
        verdict = exact_verdict(rows, got, exact, stepper.budget)
        error = f"{verdict.max_rel_error:.2g} of the relative speed"
    else:
        euler = bench_tool().expect(rows, "euler", "mathavan2014")
        verdict = euler_verdict(rows, got, euler, exact, stepper.steps, 0.02)
        error = f"{verdict.max_abs_error:.2g} m/s"
    print(f"{TARGET.name}, {name}, {compiler}: {len(rows)} cases, {error}; {verdict.reason}")
    assert verdict.passed, verdict.reason


def bench(runner: EmulatedRunner) -> Workbench:
    """With one compiler: it is enough to choose by."""
    return Workbench(bench_tool(), CACHE.parent, {"gcc": COMPILERS["gcc"]}, emulated=runner)


def exact_variant(compiler: str, tableau: str = "dp54", root: str = "inv") -> Variant:
    options = {"root": root, "fma": "fma", "compiler": compiler}
    return make_variant(
        TARGET.name, "any", "mathavan2014", Stepper(tableau, budget=1e-6), **options
    )


def test_blocks_of_both_compilers_spellings_are_told_apart() -> None:
    """GCC writes `bne`, Clang `b.ne`; `bic` is no jump, and `#` begins a number."""
    text, blocks = instrumented(
        "f:\n\tmov w0, #1 // why\n\tbne .L2\n\tbic v0.8b, v1.8b, v2.8b\n\tb.lt .L2\n\tbl hypot\n"
        "#APP\n\tnop\n.L2:\n\tret\n\t.section .rodata\n.LC0:\n\t.word 1\n",
        "aarch64",
    )
    assert blocks == (
        ("mov w0, #1", "bne .L2"),
        ("bic v0.8b, v1.8b, v2.8b", "b.lt .L2"),
        (),
        ("nop",),
        (),
    )
    assert text.count("bl carom_record") == 5


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_a_recorded_kernel_computes_what_it_does_without(runner, compiler, tmp_path) -> None:
    if compiler not in COMPILERS:
        pytest.skip(f"no {compiler}")
    tools = Workbench(bench_tool(), CACHE.parent, COMPILERS, emulated=runner)
    made = tools.built(exact_variant(compiler), TARGET)
    probe = {"probe.cpp": made.sources["probe.cpp"]}
    rest = {k: v for k, v in made.sources.items() if k not in probe}
    kernel = traced(rest, probe, made.compiler, made.flags, made.name, TARGET.row.arch)
    trace, cases = tmp_path / "trace", bench_tool().make_cases(31, 50).rows
    got = runner.run_kernel(build(kernel.job, CACHE).path, cases, way=Way(trace=trace))
    assert np.array_equal(got, runner.run_kernel(made.library.path, cases))
    each = len(kernel.instructions(trace)) / len(cases)
    print(f"{compiler}: {each:.0f} instructions a collision")
    assert 200 < each < 20_000


def judged(runner: EmulatedRunner, monkeypatch) -> tuple[Workbench, Held]:
    """The main job for 1e-6, with two candidates instead of twenty; in lanes one of each number."""
    two = [exact_variant("gcc"), exact_variant("gcc", "dop853")]
    monkeypatch.setattr(seeds, "singles_for", lambda *_: two)
    all_lanes = seeds.batch_candidates

    def few(*asked: object) -> list[Variant]:
        found = all_lanes(*asked)
        return [next(v for v in found if v["numbers"] == code) for code in ("own", "float")]

    monkeypatch.setattr(seeds, "batch_candidates", few)
    tools = bench(runner)
    asked = Contest("ball-ball", TARGET.name, "any", "mathavan2014", Goal(budget=1e-6), "scalar")
    return tools, hold(tools, asked, read_host(), 1.0)


def test_exact_kernels_are_chosen_by_what_they_execute_under_emulation(runner, monkeypatch):
    """Single calls and lanes; verified there, and never timed."""
    if find_mca() is None:
        pytest.skip("no llvm-mca on this machine")
    tools, singles = judged(runner, monkeypatch)
    choice, found = singles.choice, hold_batches(tools, singles, read_host(), 1.0)
    assert found is not None
    for name, made in (("single", choice), ("batch", found.choice)):
        chosen, entry = made.chosen, selected(made)
        assert isinstance(chosen, Estimated) and chosen.model is not None
        print(
            f"{name}: {chosen.name}, {chosen.model.cycles:.0f} cycles a collision by llvm-mca "
            f"for {chosen.model.cpu}; {chosen.verdict.reason}"
        )
        assert entry.chosen_by == "llvm-mca" and entry.measured_on == TARGET.row.mca_cpu
        assert entry.goal.budget == 1e-6 and entry.max_rel_error <= 1e-6
        assert entry.interval is None
        assert entry.ratio_to_baseline is not None and 0 < entry.ratio_to_baseline < 0.2
        assert chosen.model.cases > 0 and chosen.verdict.cases > 1000
    assert choice.chosen.variant.stepper.name == "dp54"
    lanes = found.choice.chosen.variant
    assert lanes.width == {"own": 2, "float": 4}[lanes["numbers"]]
