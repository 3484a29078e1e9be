"""The toolchain: compilers, flags, the build cache, llvm-mca."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
import textwrap
from dataclasses import replace
from pathlib import Path

import pytest

from generator.errors import KernelError, KernelTimeout
from generator.registry.variant import fixed_steps, make_variant
from generator.targets.target import find_target
from generator.toolchain import build as build_module
from generator.toolchain import compilers as compilers_module
from generator.toolchain import mca as mca_module
from generator.toolchain.build import BuildJob, build, build_library, build_many, cache_key
from generator.toolchain.compilers import Compiler, accepts_march, find_compilers, march_flags
from generator.toolchain.compilers import missing as missing_compilers
from generator.toolchain.flags import LINK_FLAGS, compile_flags
from generator.toolchain.loops import marked_loops
from generator.toolchain.mca import analyse, assembly_of, find_mca
from generator.toolchain.process import run

CODES = ("gcc", "clang", "clangold")
TWICE = 'extern "C" double twice(double x) { return x + x; }\n'
CHAIN = """
#include <cmath>
extern "C" double chain(double s, int n) {
  for (int i = 0; i < n; ++i) {
    asm volatile("# LLVM-MCA-BEGIN loop");
    s = std::sqrt(s * 1.5 + 2.0) / 3.0;
    asm volatile("# LLVM-MCA-END loop");
  }
  return s;
}
"""


def compiler_of(code: str) -> Compiler:
    for compiler in find_compilers():
        if compiler.code == code:
            return compiler
    pytest.skip(f"no {code} on this machine")


def any_compiler() -> Compiler:
    if not find_compilers():
        pytest.skip("no C++ compiler on this machine")
    return find_compilers()[0]


def need_mca() -> None:
    if find_mca() is None:
        pytest.skip("no llvm-mca on this machine")


def a_variant(**options: str):
    return make_variant("zen3", "pool", "mathavan2014", fixed_steps(1000), **options)


@pytest.mark.parametrize("code", CODES)
def test_a_built_library_computes(code, tmp_path):
    built = build_library({"k.cpp": TWICE}, (), compiler_of(code), ["-O2"], tmp_path)
    library = ctypes.CDLL(str(built.path))
    library.twice.restype, library.twice.argtypes = ctypes.c_double, [ctypes.c_double]
    assert library.twice(1.25) == 2.5
    assert not built.hit and built.log.read_text().count("$ ") == 2


def test_a_second_build_runs_no_compiler(tmp_path, monkeypatch):
    job = BuildJob("k", {"k.cpp": TWICE}, any_compiler(), ("-O2",))
    first = build(job, tmp_path)

    def refuse(*_args, **_kwargs):
        raise AssertionError("a compiler was run")

    monkeypatch.setattr(build_module, "run", refuse)
    second = build(job, tmp_path)
    assert second.hit and second.path == first.path and second.key == first.key
    assert second.seconds == pytest.approx(first.seconds, abs=1e-3)
    assert sorted(p.name for p in tmp_path.iterdir()) == [first.key]


def test_the_key_holds_all_that_shapes_a_library(tmp_path):
    header = tmp_path / "k.h"
    header.write_text("#define K 1\n")
    job = BuildJob(
        "k", {"k.cpp": TWICE}, Compiler("gcc", "/g++", "12.2", 12), ("-O2",), (tmp_path,)
    )
    keys = {
        cache_key(job),
        cache_key(replace(job, sources={"k.cpp": TWICE + " "})),
        cache_key(replace(job, sources={"l.cpp": TWICE})),
        cache_key(replace(job, flags=("-O3",))),
        cache_key(replace(job, compiler=replace(job.compiler, version="13.1"))),
    }
    header.write_text("#define K 2\n")
    keys.add(cache_key(job))
    assert len(keys) == 6
    assert cache_key(replace(job, label="other")) in keys


def test_a_damaged_entry_is_made_again(tmp_path):
    job = BuildJob("k", {"k.cpp": TWICE}, any_compiler(), ("-O1",))
    build(job, tmp_path).path.unlink()
    again = build(job, tmp_path)
    assert not again.hit and again.path.is_file()


@pytest.mark.parametrize("code", CODES)
def test_a_compile_error_is_one_line_with_the_place_of_the_log(code, tmp_path):
    with pytest.raises(KernelError) as caught:
        build_library({"k.cpp": "int f() { return y; }\n"}, (), compiler_of(code), (), tmp_path)
    message = str(caught.value)
    assert "\n" not in message and "k.cpp:1:" in message and "error" in message
    log = message.rsplit("(log: ", 1)[1].rstrip(")")
    assert "'y'" in Path(log).read_text("utf-8")
    assert [p.name for p in tmp_path.iterdir() if not p.name.endswith(".failed.log")] == []


def test_many_builds_keep_their_order_and_report_each(tmp_path):
    compiler, seen = any_compiler(), []
    texts = [TWICE, "wrong\n", TWICE.replace("x + x", "2 * x")]
    jobs = [BuildJob(f"k{n}", {"k.cpp": t}, compiler, ()) for n, t in enumerate(texts)]
    results = build_many(jobs, tmp_path, 2, lambda job, _result: seen.append(job.label))
    assert [isinstance(r, KernelError) for r in results] == [False, True, False]
    assert sorted(seen) == ["k0", "k1", "k2"]
    assert str(results[1]).startswith("k1 ")
    assert results[0].key == cache_key(jobs[0]) and results[2].key == cache_key(jobs[2])


def test_a_command_without_end_is_killed():
    with pytest.raises(KernelError, match=r"sleep took longer than 0\.2 s"):
        run(["sleep", "30"], 0.2)
    with pytest.raises(KernelError, match="cannot run /no/such"):
        run(["/no/such"], 1)


def test_a_limit_of_time_is_of_time_that_a_program_had_for_itself():
    """One that computes is killed at the limit; one that a busy machine holds up is waited for."""
    held_up = run(["sh", "-c", "read line; sleep 1; echo $line"], 0.3, text="a word\n")
    assert (held_up.code, held_up.output) == (0, "a word\n")
    before = os.times()
    with pytest.raises(KernelTimeout, match=r"sh took longer than 1 s"):
        run(["sh", "-c", "while :; do :; done"], 1.0)
    after = os.times()
    spent = after.children_user - before.children_user
    print(f"killed after {spent:.2f} s of its own time; the limit is 1 s")
    assert 0.5 <= spent < 5


def test_a_missing_compiler_is_named_with_its_package():
    gcc = Compiler("gcc", "/g++", "12.2", 12)
    text = missing_compilers([gcc])
    assert "no clang (apt-get install clang-19)" in text and "gcc" not in text
    assert missing_compilers([replace(gcc, code=c) for c in CODES]) == ""


def test_a_march_that_is_unknown_falls_back_and_says_so(monkeypatch):
    known = {"x86-64-v4", "x86-64-v3", "znver3"}
    monkeypatch.setattr(compilers_module, "accepts_march", lambda _c, march, _a="": march in known)
    gcc, clang = Compiler("gcc", "/g++", "12", 12), Compiler("clangold", "/clang++", "14", 14)
    for compiler in (gcc, clang):
        chosen = march_flags(compiler, find_target("zen5"))
        assert chosen.flags == ("-march=x86-64-v4",)
        assert chosen.note == "-march=x86-64-v4, as znver5 is unknown"
        exact = march_flags(compiler, find_target("zen3"))
        assert exact.flags == ("-march=znver3",) and exact.note == ""
    known.clear()
    with pytest.raises(KernelError, match="cannot compile for zen5"):
        march_flags(gcc, find_target("zen5"))


@pytest.mark.parametrize("code", CODES)
def test_a_compiler_tells_whether_it_knows_a_march(code):
    assert accepts_march(compiler_of(code), "x86-64-v3")
    assert not accepts_march(compiler_of(code), "no-such-cpu")


@pytest.mark.parametrize("code", CODES)
@pytest.mark.parametrize("flags", ("strict", "report"))
@pytest.mark.parametrize(
    ("fma", "contract"), (("nofma", "off"), ("fma", "off"), ("autofma", "fast"))
)
def test_contraction_is_what_the_name_says(code, flags, fma, contract):
    chosen = compile_flags(a_variant(flags=flags, fma=fma), compiler_of(code), find_target("zen3"))
    assert chosen[-1] == f"-ffp-contract={contract}"
    assert "-march=znver3" in chosen
    assert ("-Ofast" in chosen, "-mfma" in chosen) == (
        (True, True) if flags == "report" else (False,) * 2
    )


def test_the_reports_flags_ask_for_no_more_than_the_target_has():
    chosen = compile_flags(a_variant(flags="report"), any_compiler(), find_target("x86-64-v2"))
    assert "-Ofast" in chosen and "-mavx2" not in chosen and "-mfma" not in chosen


@pytest.mark.parametrize("code", CODES)
def test_the_reports_flags_leave_denormals_of_the_process_alone(code, tmp_path):
    assert not any(flag.startswith("-O") or "fast" in flag for flag in LINK_FLAGS)
    compiler = compiler_of(code)
    flags = compile_flags(a_variant(flags="report"), compiler, find_target("x86-64-v2"))
    built = build_library({"k.cpp": TWICE}, (), compiler, flags, tmp_path)
    for line in built.log.read_text().splitlines():
        assert not (line.startswith("$ ") and "-shared" in line and "-Ofast" in line)
    # In a process of its own: a constructor that sets FTZ would spoil the tests after this one.
    program = textwrap.dedent(
        """
        import ctypes, sys
        ctypes.CDLL(sys.argv[1])
        smallest = 2.2250738585072014e-308
        print((smallest * float("0.25")) * 4.0 == smallest)
        """
    )
    done = subprocess.run(
        [sys.executable, "-c", program, str(built.path)], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "True"


@pytest.mark.parametrize("code", CODES)
@pytest.mark.parametrize("flags", ("strict", "report"))
def test_mca_sees_the_chain_of_a_loop(code, flags):
    need_mca()
    compiler, zen3 = compiler_of(code), find_target("zen3")
    chosen = compile_flags(a_variant(flags=flags), compiler, zen3)
    report = analyse(assembly_of({"k.cpp": CHAIN}, (), compiler, chosen), zen3)
    assert report.cpu == "znver3"
    assert (
        20 <= report.cycles_per_iteration <= 60
    )  # square root 21, division 13, both of them waited for
    assert report.throughput_bound < report.cycles_per_iteration
    assert 3 <= report.uops <= 8
    assert report.bottleneck.startswith("waits for results")
    assert "LLVM" in report.note


LOOP = """
    main:
    .L1:
        # LLVM-MCA-BEGIN loop
        addsd %xmm1, %xmm0
        ucomisd %xmm2, %xmm0
        ja .L8
    {here}
    .L2:
        # LLVM-MCA-BEGIN loop
        addsd %xmm1, %xmm0
        decl %eax
        jne .L1
        ret
    {there}
"""
SIDE = ".L8:\n {}\n sqrtsd %xmm0, %xmm0\n jmp .L2\n"


def paths_of(assembly: str) -> list[tuple[int, int]]:
    """Lengths and iterations of the paths of the one loop."""
    (found,) = marked_loops(assembly, "loop")
    return sorted((len(path.lines), path.iterations) for path in found.paths)


def test_a_trip_of_a_loop_counts_what_usually_runs():
    moved_away = LOOP.format(here="", there=SIDE.format(""))
    assert paths_of(moved_away) == [(6, 2)]
    skipped = "jmp .L2\n" + SIDE
    assert paths_of(LOOP.format(here=skipped.format(""), there="")) == [(7, 2), (8, 2)]
    assert paths_of(LOOP.format(here=skipped.format("# CAROM-RARE"), there="")) == [(7, 2)]
    assert marked_loops(moved_away, "other") == []


def test_a_loop_inside_another_is_no_trip_of_it():
    text = """
    main:
    .L1:
        # LLVM-MCA-BEGIN take
        addsd %xmm1, %xmm0
    .L2:
        # LLVM-MCA-BEGIN frame
        mulsd %xmm1, %xmm0
        decl %eax
        jne .L2
        decl %ecx
        jne .L1
        ret
    """
    (outer,), (inner,) = marked_loops(text, "take"), marked_loops(text, "frame")
    assert [(len(path.lines), path.iterations) for path in outer.paths] == [(6, 1)]
    assert [(len(path.lines), path.iterations) for path in inner.paths] == [(3, 1)]


def test_mca_sees_every_way_through_a_loop_of_aarch64():
    need_mca()
    text = """
    main:
    .L1:
        // LLVM-MCA-BEGIN loop
        fadd d0, d0, d1
        fcmp d0, d2
        b.gt .L2
        fsqrt d0, d0
    .L2:
        fadd d0, d0, d1
        subs w0, w0, #1
        b.ne .L1
        ret
    """
    report = analyse(textwrap.dedent(text), find_target("apple-m1"))
    print(report.path_cycles)
    assert len(report.path_cycles) == 2
    assert report.cycles_per_iteration == max(report.path_cycles) > min(report.path_cycles)


def test_mca_says_what_is_missing(monkeypatch):
    need_mca()
    with pytest.raises(KernelError, match="no LLVM-MCA region 'loop'"):
        analyse("f:\n\tret\n", find_target("zen3"))
    zen3 = find_target("zen3")
    unknown = zen3.model_copy(update={"row": zen3.row.model_copy(update={"mca_cpu": "zen99"})})
    text = "# LLVM-MCA-BEGIN loop\n\taddsd %xmm0, %xmm0\n# LLVM-MCA-END loop\n"
    assert analyse(text, zen3).cycles_per_iteration >= 3
    with pytest.raises(KernelError, match="zen99"):
        analyse(text, unknown)
    monkeypatch.setattr(mca_module, "find_mca", lambda: None)
    with pytest.raises(KernelError, match="apt-get install llvm-19"):
        analyse(text, zen3)
