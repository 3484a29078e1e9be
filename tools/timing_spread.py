"""How much the time of a kernel in lanes differs by process; a script, no test.

`.venv/bin/python tools/timing_spread.py` times a batch kernel (1e-6, the widest lanes of
this CPU) against its single calls in 20 processes of 24 rounds, as the first rung of a sweep has
them, and prints the least, the median and the largest of what the processes found. `--rival PATH`
is another carom_bench, as of an earlier commit (build/cache/carom_bench-*): its processes in turn
with ours; one that does not look counts as quiet.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from generator.choice.candidates import default_lanes
from generator.choice.cases import TIMING_CASES, TIMING_SEED
from generator.evidence.timing.bench_tool import BenchTool
from generator.evidence.timing.plan import PlannedKernel, TimingPlan
from generator.evidence.timing.ratios import timing_results, timing_run
from generator.impacts.ball_ball.evidence import SHARED
from generator.registry.names import name_of
from generator.sweep.explore import TRIAL_SECONDS
from generator.sweep.ladder import QUIET, RUNGS
from tests.support.exact_kernels import built, exact_variant, host_target
from tests.support.kernels import bench_tool


def plan_of(tool: BenchTool, model: str, rounds: int) -> TimingPlan:
    """The lanes against single calls of the same kernel, on the cases of batches."""
    target = host_target()
    single = exact_variant(model, 1e-6, target=target)
    lanes = default_lanes(single, target)
    paths = built([single, lanes])
    kernels = (
        PlannedKernel(name_of(single), paths[0]),
        PlannedKernel(name_of(lanes), paths[1], batch=True),
    )
    cases = tool.make_cases(TIMING_SEED, TIMING_CASES, fixed=SHARED).rows
    return TimingPlan(cases, kernels, kernels[0].name, rounds=rounds, seconds=TRIAL_SECONDS)


def line(name: str, values: list[float], unit: str = "") -> str:
    low, middle, high = np.min(values), np.median(values), np.max(values)
    spread = f"{100 * (high / low - 1):.1f} % apart" if low > 0 else ""
    return f"  {name:24} {low:9.4g} {middle:9.4g} {high:9.4g} {unit:3} {spread}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--processes", type=int, default=20)
    parser.add_argument("--rounds", type=int, default=RUNGS[0])
    parser.add_argument("--model", default="mathavan2014")
    parser.add_argument("--rival", type=Path)
    given = parser.parse_args()
    tools = {"this bench": bench_tool()}
    if given.rival:
        tools["the rival"] = replace(bench_tool(), executable=given.rival)
    plan = plan_of(tools["this bench"], given.model, given.rounds)
    found: dict[str, list[tuple[float, float, float, float]]] = {name: [] for name in tools}
    for _ in range(given.processes):
        for name, tool in tools.items():
            begun = time.monotonic()
            run = timing_run(tool.timing_document(plan))
            lanes = timing_results(run)[1]
            found[name].append((lanes.ns, lanes.ratio, run.quiet, time.monotonic() - begun))
    print(f"{given.processes} processes of {given.rounds} rounds: least, median, largest")
    print(plan.kernels[1].name)
    for name, rows in found.items():
        quiet = [row for row in rows if row[2] >= QUIET]
        print(f"{name}: {len(rows) - len(quiet)} had fewer than eight quiet rounds; the others")
        print(line("a collision", [row[0] for row in quiet], "ns"))
        print(line("of single calls", [row[1] for row in quiet]))
        print(line("a process took", [row[3] for row in rows], "s"))


if __name__ == "__main__":
    main()
