"""What kernels execute, recorded and replayed: the choice for a CPU that is not here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from generator.choice import modelling
from generator.choice.kernel import Emitted
from generator.choice.workbench import Workbench
from generator.errors import KernelError
from generator.evidence.timing.bench_tool import Way
from generator.evidence.verification.errors import Array
from generator.impacts.ball_ball.presets import find_preset
from generator.registry.variant import Stepper, Variant, make_variant
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.build import BuildJob, build
from generator.toolchain.compilers import find_compilers
from generator.toolchain.mca import find_mca
from generator.toolchain.replay import replayed_cycles
from generator.toolchain.traces import TracedKernel, instrumented, traced
from tests.support.kernels import CACHE, EULER, bench_tool, compiler_of

TARGET = "x86-64-v3"


def need(target: str = TARGET) -> None:
    if find_mca() is None:
        pytest.skip("no llvm-mca on this machine")
    if not read_host().runs(find_target(target)):
        pytest.skip(f"this machine cannot run {target}")


def exact(tableau: str, root: str = "inv", budget: float = 1e-6, compiler: str = "gcc") -> Variant:
    stepper = Stepper(tableau, budget=budget)
    options = {"root": root, "fma": "fma", "compiler": compiler}
    return make_variant(TARGET, "any", "mathavan2014", stepper, **options)


def fixed(preset: str, compiler: str = "gcc") -> Variant:
    options = {**find_preset(preset).options, "fma": "fma", "compiler": compiler}
    return make_variant(TARGET, "any", "mathavan2014", EULER, **options)


def bench() -> Workbench:
    return Workbench(bench_tool(), CACHE.parent, {c.code: c for c in find_compilers()})


def candidate(variant: Variant) -> Emitted:
    return bench().emit(variant, find_target(TARGET))


def some_cases(count: int) -> Array:
    return bench_tool().make_cases(31, count).rows


def test_blocks_end_where_control_may_leave() -> None:
    text, blocks = instrumented(
        "f:\n\t.cfi_startproc\n\tmov %rax, %rbx # why\n\tje .L2\n\tadd $1, %rbx\n"
        "\tcall hypot@PLT\n\tnop\n.L2:\n\tret\n\t.section .rodata\n.LC0:\n\t.long 1\n",
        "x86_64",
    )
    assert blocks == (("mov %rax, %rbx", "je .L2"), ("add $1, %rbx",), ("nop",), ())
    assert text.count("pushfq") == 4
    assert text.index(".L2:") < text.index("movl $3,") < text.index("\tret")


def test_code_that_outgrows_the_cache_of_decoded_instructions_is_decoded_in_every_turn(
    tmp_path: Path,
) -> None:
    job = BuildJob("turns", {}, find_compilers()[0], ())
    blocks = (("nop",) * 3, ("nop",) * 2, ("nop",) * 4)
    np.array([0, 1, 2] * 10, dtype=np.uint32).tofile(tmp_path / "trace")
    kernel = TracedKernel(job, blocks)
    again = {size: kernel.decoded_again(tmp_path / "trace", size) for size in (8, 9, 0)}
    print(f"of 90 instructions, by what the cache holds (0: not modelled): {again}")
    assert again == {8: 90, 9: 9, 0: 0}


@pytest.mark.parametrize("code", ["gcc", "clang"])
@pytest.mark.parametrize("kind", ["exact", "fixed"])
def test_a_recorded_kernel_computes_what_it_does_without(kind: str, code: str, tmp_path) -> None:
    need()
    made = candidate(exact("dp54", compiler=code) if kind == "exact" else fixed("reduced", code))
    probe = {"probe.cpp": made.sources["probe.cpp"]}
    rest = {k: v for k, v in made.sources.items() if k not in probe}
    kernel = traced(rest, probe, compiler_of(made.variant), made.flags, made.name)
    library, trace, cases = build(kernel.job, CACHE), tmp_path / "trace", some_cases(50)
    steps = None if kind == "exact" else 20
    got = bench_tool().run_kernel(library.path, cases, steps=steps, way=Way(trace=trace))
    whole = bench().built(made.variant, find_target(TARGET)).library.path
    plain = bench_tool().run_kernel(whole, cases, steps=steps)
    assert np.array_equal(got, plain)
    each = len(kernel.instructions(trace)) / len(cases)
    print(f"{kind} {code}: {each:.0f} instructions a collision")
    assert 200 < each < 20_000
    with pytest.raises(KernelError, match="carom_trace"):
        bench_tool().run_kernel(whole, cases, way=Way(trace=trace))


def cycles_of(variant: Variant, count: int = 32) -> float:
    made, target = candidate(variant), find_target(TARGET)
    return modelling.modelled(bench(), made, target, some_cases(count)).cycles


def test_a_collision_is_compared_and_not_a_step() -> None:
    """Steps of order 8 are fewer and longer; at 1e-6 those of order 5 are faster, here too."""
    need()
    five, eight = cycles_of(exact("dp54")), cycles_of(exact("dop853"))
    print(f"haswell, 1e-6, 1 / sqrt: dp54 {five:.0f} cycles a collision, dop853 {eight:.0f}")
    assert five < 0.9 * eight


def test_fixed_steps_take_far_more_than_exact_ones() -> None:
    """Timed here: 0.03 to 0.04 of these fixed steps."""
    need()
    ratio = cycles_of(exact("dp54")) / cycles_of(fixed("reduced"))
    print(f"haswell: dp54 at 1e-6 takes {ratio:.4f} of 1000 fixed steps")
    assert 0.01 < ratio < 0.15


def test_a_batch_is_replayed_too() -> None:
    """Of a kernel with one lane it is the same collisions one after the other."""
    need()
    made, target, cases = candidate(exact("dp54")), find_target(TARGET), some_cases(32)
    cases[:, [0, 1, 2, 3, 5]] = cases[0, [0, 1, 2, 3, 5]]
    probe = {"probe.cpp": made.sources["probe.cpp"]}
    rest = {k: v for k, v in made.sources.items() if k not in probe}
    kernel = traced(rest, probe, compiler_of(made.variant), made.flags, made.name)
    single, batch = (
        modelling.replayed(bench(), kernel, target, cases, batch=b).cycles for b in (False, True)
    )
    print(f"dp54 at 1e-6 on haswell: {single:.0f} cycles a collision, in a batch {batch:.0f}")
    assert batch == pytest.approx(single, rel=0.1)


def test_what_ran_is_what_is_counted() -> None:
    """A chain of additions takes their latency, independent ones their throughput."""
    need()
    haswell = find_target(TARGET)
    chain = ["addsd %xmm1, %xmm0"] * 10_000
    apart = [f"addsd %xmm15, %xmm{n % 12}" for n in range(10_000)]
    assert replayed_cycles(chain, haswell) == pytest.approx(30_000, rel=0.01)
    assert replayed_cycles(apart, haswell) == pytest.approx(10_000, rel=0.02)
    assert replayed_cycles(chain * 8, haswell) == pytest.approx(240_000, rel=0.01)
