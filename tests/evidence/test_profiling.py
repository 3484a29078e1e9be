"""Sections of a kernel by sampling, and misses as valgrind simulates them."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from generator.choice.modelling import frame_cycles
from generator.emission.kernel_source import KernelSource, emit
from generator.emission.marks import without_marks
from generator.evidence.profiling.misses import own_costs, simulate_misses
from generator.evidence.profiling.passes import steps_a_collision
from generator.evidence.profiling.sampling import sample
from generator.evidence.profiling.sections import SECTIONS, sections_of
from generator.impacts.ball_ball.presets import find_preset
from generator.registry.variant import Stepper, Variant, fixed_steps, make_variant
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.build import build_library
from generator.toolchain.flags import compile_flags
from generator.toolchain.loops import marked_loops
from generator.toolchain.mca import analyse, assembly_of, find_mca, with_regions
from tests.support.kernels import CACHE, bench_tool, compiler_of

EULER = fixed_steps(1000)


def _kernel(preset: str, target: str = "x86-64-v2") -> tuple[Variant, KernelSource]:
    options = {**find_preset(preset).options, "fma": "nofma"}
    variant = make_variant(target, "any", "mathavan2014", EULER, **options)
    return variant, emit(variant)


def _with_regions(source: KernelSource) -> dict[str, str]:
    return {"carom.h": source.header, "kernel.cpp": with_regions(source.marked)}


def _line(source: str, text: str) -> int:
    return next(n for n, line in enumerate(source.splitlines()) if text in line)


def test_lines_of_a_kernel_belong_to_the_section_that_they_serve() -> None:
    wanted = {
        "const double distance = std::sqrt(square);": "pre-loop",
        "const double n_c = c_x * c_x + c_z * c_z;": "impulse",
        "c_x = c_x + 7.0 * h_x * i_c;": "update",
        "W += half_dP * std::fabs(v_n_before + v_n);": "update",
        "const double dc_x = c_x - c_x_0;": "post-loop",
        "out1[3] = b.v1x * b.f_y + b.v1y * b.f_x;": "post-loop",
    }
    marked = _kernel("reduced-ahead")[1].marked
    source, found = without_marks(marked), sections_of(marked)
    for text, section in wanted.items():
        assert found[_line(source, text)] == section, text
    assert found[_line(source, "inline double exact_rsqrt(double n)")] is None  # its caller's
    assert len(found) == len(source.splitlines())
    exact = make_variant("x86-64-v2", "any", "mathavan2014", Stepper("dp54", budget=1e-6))
    marked = emit(exact.with_options(fma="nofma")).marked
    source, found = without_marks(marked), sections_of(marked)
    assert found[_line(source, "const Real i_cs = i_c * i_s;")] == "impulse"
    assert found[_line(source, "// Accept or shrink")] == "update"


def test_samples_of_the_report_s_kernel_fall_almost_all_into_the_loop() -> None:
    variant, source = _kernel("paper-initial")
    compiler = compiler_of(variant)
    flags = compile_flags(variant, compiler, find_target(variant.target))
    cases = bench_tool().make_cases(1, 256).rows
    found = sample(source, compiler, flags, cases, 0.5, CACHE)
    print(f"{found.samples} samples, {found.unknown:.2%} unknown, {dict(found.shares)}")
    assert set(found.shares) == set(SECTIONS)
    assert sum(found.shares.values()) + found.unknown == pytest.approx(1)
    assert found.samples > 100
    assert found.unknown < 0.05
    assert found.shares["impulse"] + found.shares["update"] > 0.9
    assert found.counters or found.no_counters  # one or the other, never silence


@pytest.mark.skipif(shutil.which("valgrind") is None, reason="no valgrind")
def test_valgrind_counts_the_kernel_alone() -> None:
    variant, source = _kernel("reduced-ahead")
    compiler = compiler_of(variant)
    flags = compile_flags(variant, compiler, find_target(variant.target))
    library = build_library(source.files, (), compiler, flags, CACHE)
    cases = bench_tool().make_cases(1, 64).rows
    found = simulate_misses(bench_tool().executable, library.path, cases)
    print(found)
    # A thousand iterations of some 80 instructions and two branches, nearly all of them guessed.
    assert 30_000 < found.events["instructions"] < 300_000
    assert 1_000 < found.events["branches"] < 20_000
    assert 0 < found.events["branch_misses"] < 0.05 * found.events["branches"]
    assert read_host().runs(find_target(variant.target))


def test_calls_into_other_libraries_are_left_out() -> None:
    profile = """events: Ir Bc Bcm
ob=(1) /tmp/kernel.so
fl=(1) kernel.cpp
fn=(1) collide
10 100 7 1
+3 50
cob=(2) /lib/libm.so
cfn=(2) exp
calls=2 40
* 1000 9 9
ob=(2)
fn=(2)
40 1000 9 9
ob=(1)
fn=(1)
-2 5 5 5
"""
    assert own_costs(profile.splitlines(), Path("/tmp/kernel.so")) == {
        "Ir": 155,
        "Bc": 12,
        "Bcm": 6,
    }


def test_a_loop_of_exact_lanes_has_a_bound_that_its_steps_scale(tmp_path: Path) -> None:
    target = find_target("x86-64-v2")
    exact = Stepper("dp54", budget=1e-6)
    wide = make_variant("x86-64-v2", "any", "mathavan2014", exact, 2, fma="nofma", root="est1")
    compiler = compiler_of(wide)
    cases = bench_tool().make_cases(11, 300).rows
    steps = steps_a_collision(wide, compiler, target, cases, CACHE)
    once = steps_a_collision(wide, compiler, target, cases[:1], CACHE)
    print(f"{steps:.3f} steps a collision, {once:.0f} of the first")
    assert 1.0 < steps < 4.0 and once == round(once)
    if find_mca() is None:
        pytest.skip("llvm-mca is not installed")
    sources = _with_regions(emit(wide))
    text = assembly_of(sources, (), compiler, compile_flags(wide, compiler, target), "bound")
    report = analyse(text, target, "lanes")
    print(f"{report.throughput_bound:.0f} cycles a pass of two lanes; {report.note}")
    assert 300 < report.throughput_bound < report.cycles_per_iteration


def test_reading_and_writing_a_collision_has_a_bound_too() -> None:
    """In doubles and, the frame being half as wide, where steps are made in floats."""
    if find_mca() is None:
        pytest.skip("llvm-mca is not installed")
    target = find_target("x86-64-v3")
    options = {"fma": "fma", "root": "est1", "interleave": "s2"}
    head = ("x86-64-v3", "any", "mathavan2014", Stepper("dp54", budget=1e-6))
    bounds = {}
    for width, numbers in ((4, "own"), (8, "float")):
        wide = make_variant(*head, width, numbers=numbers, **options)
        compiler = compiler_of(wide)
        sources = _with_regions(emit(wide))
        text = assembly_of(sources, (), compiler, compile_flags(wide, compiler, target), "bound")

        def bound(region: str, text: str = text) -> float:
            return analyse(text, target, region).throughput_bound

        bounds[numbers] = frame_cycles(wide, target, bound)
        regions = {name: bound(name) for name in ("take", "frame", "leave")}
        print(f"{numbers}: {bounds[numbers]:.1f} cycles a collision; {regions}")
        assert regions["frame"] <= regions["take"]
        trips = {p.iterations for loop in marked_loops(text, "frame") for p in loop.paths}
        assert trips == {1}  # unrolled, "take" would hold both
    # Both move the same doubles.
    assert 20 < bounds["float"] < 1.2 * bounds["own"] < 150
