"""Kernels under the worst root estimates that specifications allow, whatever this CPU's are."""

import subprocess
from dataclasses import replace

import numpy as np
import pytest

from generator.choice import verifier, verifying
from generator.choice.entries import found_errors
from generator.choice.kernel import Rejected, verdict_of
from generator.choice.workbench import Workbench
from generator.emission.kernel_source import emit
from generator.evidence.timing.bench_tool import Way
from generator.evidence.verification.worst_estimates import (
    HEADER,
    PATTERNS,
    at_worst,
    header_text,
)
from generator.impacts.ball_ball.evidence import MODELS
from generator.impacts.ball_ball.evidence.measure import errors_of
from generator.impacts.ball_ball.presets import find_preset
from generator.impacts.ball_ball.row import BALL_BALL
from generator.lowering.isa import estimates_in
from generator.registry.lanes import widths_of
from generator.registry.rules import broken_rule
from generator.registry.variant import Stepper, fixed_steps, make_variant
from generator.steppers.budgets import tableaus_for
from generator.targets.host import read_host
from generator.targets.target import RSQRT14_ERROR, RSQRTSS_ERROR, find_target, targets
from generator.toolchain.build import BuildJob, BuiltLibrary
from generator.toolchain.compilers import compilers_for, find_compilers
from tests.support.exact_kernels import Worst, load_hard, portable_target
from tests.support.kernels import bench_tool, build_all
from tests.support.reference import load_reference

PROGRAM = """
#include <stdio.h>
#include <math.h>
template <class V, class N> void ask(const char* name, V (*function)(V)) {
  double least = 1, most = -1;
  for (int i = 0; i < 100000; ++i) {
    N lanes[sizeof(V) / sizeof(N)];
    for (N& lane : lanes) lane = static_cast<N>(exp(40 * (i / 50000.0 - 1)) * (1 + i));
    V x;
    memcpy(&x, lanes, sizeof x);
    x = function(x);
    N got[sizeof(V) / sizeof(N)];
    memcpy(got, &x, sizeof x);
    for (unsigned k = 0; k < sizeof(V) / sizeof(N); ++k) {
      const double off = got[k] * sqrt(static_cast<double>(lanes[k])) - 1;
      least = off < least ? off : least;
      most = off > most ? off : most;
    }
  }
  printf("%s %.17g %.17g\\n", name, least, most);
}
int main() {
  ask<__m128, float>("sse", [](__m128 x) { return _mm_rsqrt_ps(x); });
#ifdef __AVX__
  ask<__m256, float>("sse", [](__m256 x) { return _mm256_rsqrt_ps(x); });
#endif
#ifdef __AVX512VL__
  ask<__m512d, double>("fourteen", [](__m512d x) { return _mm512_maskz_rsqrt14_pd(255, x); });
  ask<__m256d, double>("fourteen", [](__m256d x) { return _mm256_rsqrt14_pd(x); });
  ask<__m512, float>("fourteen", [](__m512 x) { return _mm512_maskz_rsqrt14_ps(65535, x); });
#endif
}
"""


def test_replaced_estimates_are_off_by_what_their_specification_allows(tmp_path):
    """As far as allowed and no further, in each pattern, for each instruction that runs here."""
    (tmp_path / "ask.cpp").write_text(f'#include "{HEADER}"\n{PROGRAM}')
    (tmp_path / HEADER).write_text(header_text())
    march = max(
        (t for t in targets().values() if t.name.startswith("x86-64-v") and read_host().runs(t)),
        key=lambda t: len(t.features),
    ).row.march
    words = ["g++", "-O2", "-std=c++17", f"-march={march}", "ask.cpp", "-o", "ask"]
    subprocess.run(words, cwd=tmp_path, check=True, timeout=900)
    bounds = {"sse": RSQRTSS_ERROR, "fourteen": RSQRT14_ERROR}
    for pattern in PATTERNS:
        done = subprocess.run(
            ["./ask"], cwd=tmp_path, env=pattern.environment(), capture_output=True, text=True
        )
        for line in done.stdout.splitlines():
            name, least, most = line.split()
            least, most, bound = float(least), float(most), bounds[name]
            print(f"{pattern.name}, {name}: {least / bound:.5f} to {most / bound:.5f} of the bound")
            shares = (pattern.one, pattern.other)
            assert -bound <= least <= most <= bound
            assert least == pytest.approx(min(shares) * bound, abs=4e-3 * bound)
            assert most == pytest.approx(max(shares) * bound, abs=4e-3 * bound)
    done = subprocess.run(["./ask"], cwd=tmp_path, env={}, capture_output=True, text=True)
    assert done.returncode != 0 and "no pattern" in done.stderr


def _every_kind(target):
    """A kernel for each width and kind of number on a target, the fixed-step ones among them."""
    fma = "fma" if target.has("fma") else "nofma"
    for width in widths_of(target):
        lanes = {"lane_root": "est1"} if width > 1 else {}
        yield make_variant(
            target.name, "any", "pooltool", Stepper("dp54", budget=1e-3), width,
            root="est1", fma=fma, **lanes,
        )  # fmt: skip
        options = {**find_preset("reduced-ahead").options, "rsqrt": "est1", "fma": fma, **lanes}
        yield make_variant(target.name, "any", "pooltool", fixed_steps(10), width, **options)
    for width in widths_of(target, "float"):
        yield make_variant(
            target.name, "arcade", "pooltool", Stepper("ss43", budget=1e-1), width,
            root="est0", fma=fma,
        )  # fmt: skip
    slips = {"rsqrt": "est2", "loop": "twostage", "reuse": "precompute", "simd": "slips"}
    options = {**find_preset("reduced-ahead").options, **slips, "fma": fma}
    yield make_variant(target.name, "any", "pooltool", fixed_steps(10), 1, **options)


@pytest.mark.parametrize("name", ["x86-64-v2", "x86-64-v3", "x86-64-v4"])
def test_every_estimate_that_is_emitted_can_be_replaced(name):
    target, compiler = find_target(name), find_compilers()[0]
    found = {}
    for variant in _every_kind(target):
        assert broken_rule(variant, target) is None
        source = emit(variant)
        texts = {"kernel.cpp": source.source}
        job = at_worst(BuildJob(source.source_name, texts, compiler, ()))
        assert job.sources[HEADER] == header_text()
        found[source.source_name] = estimates_in(source.source)
        assert "rsqrt" not in source.source or found[source.source_name]
    print(f"{name}: {sorted(frozenset().union(*found.values()))} in {len(found)} kernels")
    assert all(found.values())


def test_arm_estimates_are_not_replaced_since_they_are_defined_to_the_bit():
    target = find_target(next(t.name for t in targets().values() if t.has("neon")))
    variant = make_variant(
        target.name, "any", "pooltool", Stepper("dp54", budget=1e-3), root="est2", fma="fma"
    )
    text = emit(variant).source
    assert "vrsqrted_f64" in text and not estimates_in(text)


@pytest.mark.parametrize("model", MODELS)
def test_a_root_that_is_off_moves_results_by_no_more_than_the_rules_say(model):
    """Friction that is off by a share moves the exact result by at most so many of it."""
    tool, share = bench_tool(), 1e-7
    drawn = tool.make_cases(2014, 1500, mixed=False).rows
    cases = np.vstack([load_reference().cases, load_hard()[1], drawn])
    exact, largest = tool.expect(cases, "exact", model), 0.0
    for columns in ([2, 3, 4], [2, 3], [4]):  # of all roots, of the table's, of the balls'
        moved = cases.copy()
        moved[:, columns] *= 1 - share
        off = errors_of(cases, tool.expect(moved, "exact", model), exact).relative / share
        largest = max(largest, float(off.max()))
    allowed = BALL_BALL.sensitivity(model).amplification
    print(f"{model}: {largest:.4g} of what roots are off by; the rules say {allowed}")
    assert largest <= allowed


# target, lanes, numbers, root: every instruction with its latitude, in doubles and in floats.
FAMILIES = (
    ("x86-64-v2", 1, "own", "est0"),
    ("x86-64-v2", 1, "own", "est1"),
    ("x86-64-v2", 1, "own", "cubic"),
    ("x86-64-v2", 4, "float", "cubic"),
    ("x86-64-v2", 4, "float", "est1"),
    ("x86-64-v3", 8, "float", "cubic"),
    ("x86-64-v3", 8, "float", "est1"),
    ("x86-64-v4", 1, "own", "est0"),
    ("x86-64-v4", 8, "own", "est0"),
    ("x86-64-v4", 8, "own", "est1"),
    ("x86-64-v4", 16, "float", "cubic"),
    ("x86-64-v4", 16, "float", "est1"),
)
SHORT = {  # the others are for `-m long`
    ("pooltool", *FAMILIES[1]),
    ("pooltool", *FAMILIES[3]),
    ("bottom_slip", *FAMILIES[1]),
    ("bottom_slip", *FAMILIES[9]),
}
AT_THE_LIMIT = [
    pytest.param(model, *family, marks=() if (model, *family) in SHORT else pytest.mark.long)
    for model in MODELS
    for family in FAMILIES
]


def _tightest(model, target, width, numbers, root):
    """The legal kernel with the smallest budget, of those that are 2 % apart."""
    fma = "fma" if target.has("fma") else "nofma"
    lanes = {"lane_root": root, "numbers": numbers, "interleave": "s2"} if width > 1 else {}
    for budget in map(float, 1e-1 * 1.02 ** -np.arange(1200)):
        for tableau in tableaus_for(budget)[:1]:
            stepper = Stepper(tableau, budget=float(f"{budget:.3g}"))
            made = make_variant(
                target.name, "any", model, stepper, width, root=root, fma=fma, **lanes
            )
        if broken_rule(made, target) is not None:
            break
        found = made
    return found


@pytest.mark.parametrize(("model", "name", "width", "numbers", "root"), AT_THE_LIMIT)
def test_the_tightest_legal_budget_holds_under_the_worst_estimates(
    model, name, width, numbers, root
):
    target, tool = find_target(name), bench_tool()
    if not read_host().runs(target):
        pytest.skip(f"{name} code does not run on this CPU")
    variant = _tightest(model, target, width, numbers, root)
    library = build_all([variant], worst=True)[0]
    assert isinstance(library, BuiltLibrary), library
    cases = np.vstack([load_reference().cases, load_hard()[1], tool.make_cases(77, 3000).rows])
    want = tool.expect(cases, "exact", model)
    for pattern in PATTERNS:
        got = tool.run_kernel(
            library.path, cases, batch=width > 1, way=Way(environment=pattern.environment())
        )
        worst = Worst(variant.stepper.budget)
        worst.add(cases, ["all"] * len(cases), got, want)
        budget = variant.stepper.budget
        print(f"{budget:g}, {pattern.name}: {worst.error:.2g}, {worst.error / budget:.2f} of it")
        assert worst.passed, f"{pattern.name}: {worst.line()}"


def _verified(patterns, monkeypatch, tmp_path):
    """A kernel with estimates through the workbench, under the patterns given."""
    for module in (verifying, verifier):  # what runs, and the key under which it is kept
        monkeypatch.setattr(module, "PATTERNS", patterns)
    target = portable_target()
    compilers = {c.code: c for c in compilers_for(target)}
    bench = Workbench(bench_tool(), tmp_path, compilers)
    fma = "fma" if target.has("fma") else "nofma"
    stepper = Stepper("dp54", budget=1e-4)
    variant = make_variant(target.name, "any", "pooltool", stepper, root="est1", fma=fma)
    return bench.check(bench.emit(variant, target))


def test_a_kernel_that_holds_on_this_cpu_alone_is_rejected(monkeypatch, tmp_path):
    held = _verified(PATTERNS, monkeypatch, tmp_path)
    assert not isinstance(held, Rejected) and held.verdict.passed
    entry = found_errors(held.verdict)
    print(entry)
    assert entry["max_rel_error"] >= entry["worst_estimate_error"] > 0
    far = tuple(replace(p, one=60 * p.one, other=60 * p.other) for p in PATTERNS[1:2])
    failed = _verified(far, monkeypatch, tmp_path)
    assert isinstance(failed, Rejected)
    print(failed.text)
    assert failed.text.startswith("verification: with root estimates all too small: case ")
    assert not verdict_of(failed).passed
