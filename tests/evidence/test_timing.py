"""carom_bench as the generator drives it, with the oracle in place of a kernel."""

from __future__ import annotations

import dataclasses
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from generator.errors import KernelError
from generator.evidence.timing.bench_tool import (
    ROOT,
    BenchTool,
    Way,
    build_bench_tool,
    timing_hash,
)
from generator.evidence.timing.plan import PlannedKernel, TimingPlan
from generator.evidence.timing.ratios import (
    Measurement,
    TimingRun,
    control_band,
    median_interval,
    timing_results,
    timing_run,
)
from generator.evidence.timing.rounds import Rounds
from generator.impacts.ball_ball.evidence import MODELS
from generator.impacts.ball_ball.evidence.fixed_steps import euler_verdict
from generator.impacts.ball_ball.evidence.measure import STICKS, VELOCITIES, errors_of
from generator.impacts.registry import find_impact
from generator.places import cache_folder
from tests.support.reference import exact_verdict, load_reference

ORACLE = ROOT / "tests" / "oracle" / "ball_ball"
BAD = """
#include <csignal>
extern "C" int carom_probe_collide(const double*, const double*, const double*, double*, double*)
{ %s return 0; }
"""

WAKES = """
#include <chrono>
using Clock = std::chrono::steady_clock;
static void idle(long ns) { for (auto from = Clock::now(); (Clock::now() - from).count() < ns;) {} }
extern "C" int carom_probe_collide(const double*, const double*, const double*, double*, double*) {
  static Clock::time_point last;
  if ((Clock::now() - last).count() > 100000) idle(%d);
  idle(200);
  last = Clock::now();
  return 0;
}
"""


def compiled(folder: Path, name: str, source: str, *flags: str) -> Path:
    library = folder / f"{name}.so"
    command = ["c++", "-std=c++17", "-O2", "-shared", "-fPIC", "-ffp-contract=off", *flags]
    command += [f"-I{ORACLE}", "-x", "c++", "-", "-o", str(library)]
    subprocess.run(command, input=source, text=True, check=True, timeout=60)
    return library


@pytest.fixture(scope="session")
def tool() -> BenchTool:
    return build_bench_tool(cache_folder())  # one for all workers and later runs


@pytest.fixture(scope="module")
def oracle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    source = (ORACLE / "probe_kernel.cpp").read_text("utf-8")
    return compiled(tmp_path_factory.mktemp("oracle"), "oracle", source)


def test_build_is_cached(tool: BenchTool) -> None:
    assert build_bench_tool(tool.executable.parent) == tool


def checkout(folder: Path, says: str) -> Path:
    """What build_bench_tool needs of a checkout, with a program that only says something."""
    (folder / "bench").mkdir(parents=True)
    lines = ["cmake_minimum_required(VERSION 3.20)", "project(t CXX)", "add_subdirectory(bench)"]
    (folder / "CMakeLists.txt").write_text("\n".join(lines), encoding="utf-8")
    (folder / "bench" / "CMakeLists.txt").write_text(
        "add_executable(carom_bench_ball_ball m.cpp)\n"
    )
    source = f'#include <cstdio>\nint main() {{ std::puts("{says}"); }}\n'
    (folder / "bench" / "m.cpp").write_text(source, encoding="utf-8")
    return folder


def test_checkouts_share_a_cache(tmp_path: Path) -> None:
    """CAROM_CACHE may be the same for several; each gets the bench of its own sources."""
    says = ("one", "two", "one")
    roots = [checkout(tmp_path / f"{i}", text) for i, text in enumerate(says)]
    built = [build_bench_tool(tmp_path / "cache", root).executable for root in roots]
    told = [subprocess.run([p], capture_output=True, text=True, check=True).stdout for p in built]
    assert tuple(text.strip() for text in told) == says
    assert built[0] == built[2] != built[1]  # the same sources are built once


def test_records_stay_those_of_todays_bench_while_only_what_does_not_time_is_edited(
    tmp_path: Path,
) -> None:
    """An oracle, a program's reading and writing, a comment; not so the loop around the calls."""
    impact, root = find_impact("ball-ball"), tmp_path / "carom"
    for folder in ("bench", "tests/oracle"):
        shutil.copytree(ROOT / folder, root / folder)
    before = timing_hash(impact, root)
    for name in ("tests/oracle/ball_ball/exact_solver.h", "bench/time_plan.cpp", "bench/main.cpp"):
        path = root / name
        path.write_text(f"{path.read_text('utf-8')}\nint more;\n", "utf-8")
    loop = root / "bench" / "workload.cpp"
    loop.write_text(f"// A remark.\n\n{loop.read_text('utf-8')}", "utf-8")
    assert timing_hash(impact, root) == before == timing_hash(impact)
    loop.write_text(f"{loop.read_text('utf-8')}\nint more;\n", "utf-8")
    assert timing_hash(impact, root) != before


def test_cases_are_seeded_and_parameters_fixed(tool: BenchTool) -> None:
    plain = tool.make_cases(7, 300)
    fixed = tool.make_cases(7, 300, fixed={"R": 0.028575, "e_b": 0.95})
    assert np.array_equal(plain.rows, tool.make_cases(7, 300).rows)
    assert not np.array_equal(plain.rows, tool.make_cases(8, 300).rows)
    assert len(plain.kinds) == 300
    assert set(fixed.rows[:, 0]) == {0.028575}
    assert set(fixed.rows[:, 5]) == {0.95}
    spins = [rows[:, [12, 13, 14, 21, 22, 23]] * rows[:, :1] for rows in (plain.rows, fixed.rows)]
    assert spins[0] == pytest.approx(spins[1], rel=1e-12)


def test_expected_results_are_the_reference(tool: BenchTool) -> None:
    reference = load_reference()
    for model in MODELS:
        got = tool.expect(reference.cases, "exact", model)
        verdict = exact_verdict(reference.cases, got, reference.exact[model], 1e-10)
        print(f"{model}: {verdict.max_rel_error:.3g} of the relative speed")
        assert verdict.passed, verdict.reason  # 1e-11 where positions far off cost digits
        assert np.array_equal(got[:, STICKS], reference.exact[model][:, STICKS])


def test_oracle_in_double_passes(tool: BenchTool, oracle: Path) -> None:
    rows = np.vstack([load_reference().cases, tool.make_cases(5, 1500, mixed=False).rows])
    exact = tool.expect(rows, "exact", "mathavan2014")
    euler = tool.expect(rows, "euler", "mathavan2014")
    got = tool.run_kernel(oracle, rows)
    verdict = euler_verdict(rows, got, euler, exact, 1000)
    print(verdict)
    assert verdict.passed, verdict.reason
    wrong = tool.run_kernel(oracle, rows, steps=999)
    assert not euler_verdict(rows, wrong, euler, exact, 1000).passed


def test_batch_in_place_and_steps_agree(tool: BenchTool, oracle: Path) -> None:
    rows = tool.make_cases(9, 200, fixed={"R": 0.03, "M": 0.2, "u_s1": 0.2, "u_s2": 0.2}).rows
    rows[3, 10] = np.nan
    rows[4, 18:21] = 2 * rows[4, 9:12]
    plain = tool.run_kernel(oracle, rows)
    assert plain[3, VELOCITIES] == 2
    assert errors_of(rows, plain, tool.run_kernel(oracle, rows, batch=True)).absolute.max() == 0
    both = tool.run_kernel(oracle, rows, batch=True, way=Way(in_place=True))
    assert errors_of(rows, plain, both).absolute.max() == 0
    steps = tool.run_kernel(oracle, rows, steps=1000, way=Way(in_place=True))
    assert errors_of(rows, plain, steps).absolute.max() == 0


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("std::raise(SIGSEGV);", "crashed with SIGSEGV"),
        ("volatile bool on = true; while (on) {}", "took longer than 1 s"),
    ],
)
def test_bad_kernels_are_named(tool: BenchTool, tmp_path: Path, body: str, reason: str) -> None:
    library = compiled(tmp_path, "bad", BAD % body)
    with pytest.raises(KernelError, match=reason):
        tool.run_kernel(library, np.ones((1, 24)), timeout=1)


def test_missing_kernel_and_function_are_named(tool: BenchTool, tmp_path: Path) -> None:
    with pytest.raises(KernelError, match="cannot be loaded"):
        tool.run_kernel(tmp_path / "none.so", np.ones((1, 24)))
    library = compiled(tmp_path, "scalar", BAD % "")
    with pytest.raises(KernelError, match="has no function carom_probe_batch"):
        tool.run_kernel(library, np.ones((1, 24)), batch=True)


def test_timing_tells_half_from_whole(tool: BenchTool, tmp_path: Path) -> None:
    source = (ORACLE / "probe_kernel.cpp").read_text("utf-8")
    flags = {"whole": 200, "again": 200, "half": 100}
    built = {k: compiled(tmp_path, k, source, f"-DCAROM_PROBE_N={n}") for k, n in flags.items()}
    plan = TimingPlan(
        cases=tool.make_cases(1, 4096).rows,
        kernels=tuple(
            PlannedKernel(name, path, batch=name == "again", latency=name == "half")
            for name, path in built.items()
        ),
        baseline="whole",
        seed_cases=tool.make_cases(2, 5).rows,
        rounds=60,
        seconds=5,
        block_ms=0.5,
    )
    run = tool.time(plan)
    results = {result.name: result for result in timing_results(run)}
    print(f"{run.rounds} rounds, A/A band {control_band(run)}, {run.tsc_ghz:.3f} GHz")
    for result in results.values():
        print(result)
    assert 0.4 < results["half"].ratio < 0.6
    assert Rounds((run,)).apart("whole", "half")
    assert results["whole"].ratio == 1
    assert results["half"].latency_ns and results["half"].seed_ns
    assert results["again"].latency_ns is None


def planted(**ns: list[float]) -> TimingRun:
    arrays = {name: np.array(values) for name, values in ns.items()}
    control = arrays.pop("control")
    series = Measurement(ns=arrays, ticks=arrays, control=control)
    return TimingRun(next(iter(arrays)), len(control), series, None, None, 2.0, 0)


def measured(quiet: list[bool]) -> TimingRun:
    """What the bench says of a kernel that takes 100 ns, and 150 beside another thread."""
    rounds = [100.0 if alone else 150.0 for alone in quiet]
    series = {"ns_per_collision": rounds, "tsc_cycles_per_collision": rounds}
    throughput = {"kernels": [{"name": "kernel", **series}], "control": series}
    none = {"latency": None, "seed_cases": None}
    return timing_run(
        {"throughput": throughput, **none, "baseline": 0, "rounds": len(rounds), "quiet": quiet}
        | {"tsc_ghz": 2.0, "cpu": 0}
    )


def test_rounds_beside_other_work_do_not_count_where_eight_were_quiet() -> None:
    for quiet, counting, ns in ((8, 8, 100), (7, 24, 150), (24, 24, 100)):
        run = measured([True] * quiet + [False] * (24 - quiet))
        [result] = timing_results(run)
        print(f"{quiet} of 24 quiet: {run.rounds} rounds, {result.ns} ns, quiet {run.quiet:.2f}")
        assert (run.rounds, result.ns) == (counting, ns)
        assert run.quiet == pytest.approx(quiet / counting)


def test_the_bench_says_which_rounds_were_quiet(tool: BenchTool, tmp_path: Path) -> None:
    """It goes on until as many were as are asked for, within half of its time, and no longer."""
    library = compiled(tmp_path, "idles", WAKES % 0)
    cases = tool.make_cases(1, 4096).rows
    plan = TimingPlan(cases, (PlannedKernel("k", library),), "k", rounds=20, seconds=4)
    begun = os.times()
    document = tool.timing_document(plan)
    ended = os.times()
    took = ended.elapsed - begun.elapsed
    worked = ended.children_user - begun.children_user  # it waits by working: busy or not
    quiet = document["quiet"]
    print(f"{sum(quiet)} of {len(quiet)} rounds quiet in {took:.1f} s; asked for {plan.rounds}")
    assert worked < 1.5 * plan.seconds
    assert sum(quiet) == plan.rounds or took > 0.4 * plan.seconds
    assert len(quiet) == document["rounds"] == len(document["throughput"]["control"]["looks"])
    assert sum(quiet) <= plan.rounds <= len(quiet)


def test_blocks_are_timed_warm(tool: BenchTool, tmp_path: Path) -> None:
    """A kernel that idles for 0.1 ms wherever it was not called for that long costs no more."""
    built = {k: compiled(tmp_path, k, WAKES % n) for k, n in {"awake": 0, "wakes": 100_000}.items()}
    plan = TimingPlan(
        cases=tool.make_cases(1, 4096).rows,
        kernels=tuple(PlannedKernel(name, path) for name, path in built.items()),
        baseline="awake",
        seed_cases=tool.make_cases(2, 5).rows,
        rounds=60,
        seconds=5,
        block_ms=0.5,
    )
    wakes = {result.name: result for result in timing_results(tool.time(plan))}["wakes"]
    print(wakes)
    low, high = wakes.ratio_ci  # wide on a busy machine
    assert low < 1.1 and high > 0.9  # cold it would be 1.2


def test_ties_need_the_band_or_the_interval() -> None:
    rng = np.random.default_rng(1)
    base = 100 + rng.normal(0, 0.1, 101)
    run = planted(
        base=list(base),
        control=list(base * (1 + rng.normal(0, 1e-3, 101))),
        near=list(base * 0.802),
        best=list(base * 0.8),
        slow=list(base * 0.82),
        noisy=list(base * 0.8 * (1 + np.linspace(-0.2, 0.24, 101))),
    )
    print(control_band(run), [(r.name, r.ratio, r.ratio_ci) for r in timing_results(run)])
    rounds = Rounds((run,))
    apart = [name for name in run.throughput.ns if rounds.apart(name, "best")]
    assert apart == ["base", "slow"]
    assert control_band(run) == (1 / 1.005, 1.005)
    assert rounds.fastest(("base", "slow")) == "slow"
    assert rounds.fastest(list(run.throughput.ns)) == "best"


def test_control_band_widens_with_noise() -> None:
    base = np.full(40, 100.0)
    run = planted(base=list(base), control=list(base * 1.03))
    assert control_band(run) == pytest.approx((1 / 1.03, 1.03))


def test_median_interval_covers_the_median() -> None:
    assert median_interval(np.arange(5.0)) == (0, 4)
    assert median_interval(np.arange(1.0, 26.0)) == (8, 18)  # the tables' ranks for n = 25
    rng = np.random.default_rng(2)
    intervals = [median_interval(rng.exponential(size=41)) for _ in range(2000)]
    share = np.mean([low <= np.log(2) <= high for low, high in intervals])
    print(f"covers {share:.3f}")
    assert 0.94 < share < 0.98


def test_plans_and_results_are_checked() -> None:
    kernel = PlannedKernel("a", Path("a.so"))
    with pytest.raises(ValueError, match="baseline"):
        TimingPlan(np.ones((1, 24)), (kernel,), "b")
    with pytest.raises(ValueError, match="same name"):
        TimingPlan(np.ones((1, 24)), (kernel, dataclasses.replace(kernel)), "a")
    with pytest.raises(KernelError, match="not complete"):
        timing_run({"throughput": None})
