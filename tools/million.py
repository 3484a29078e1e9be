"""The proof of the exact kernels, the long part: a million random cases a model.

`.venv/bin/python tools/million.py` (or `pytest -m long`) runs the kernel of
every budget, in GCC and Clang, and its batches in floats where it has them, for all models over
the reference and a million random cases of all kinds, prints a table and writes
build/exact_errors.json. Exit status 1 where a budget does not hold; `steep` counts cases beyond it
that a rounding of the input moves as far. The oracle's answers take ten minutes the first time and
are kept in build/cache/oracle.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from generator.evidence.timing.bench_tool import ROOT, BenchTool
from generator.impacts.ball_ball.evidence import EVIDENCE, MODELS
from generator.registry.lane_numbers import float_lanes
from generator.registry.names import name_of
from generator.registry.variant import Variant
from generator.targets.host import read_host
from generator.targets.target import Target
from tests.support.exact_kernels import (
    BUDGETS,
    COMPILERS,
    Worst,
    built,
    conditioning,
    exact_variant,
    hexfloats,
    keep,
    load_hard,
    roots_for,
)
from tests.support.kernels import bench_tool
from tests.support.oracle_cache import Chunk, chunks, expected_of
from tests.support.reference import load_reference

COUNT = 1_000_000
REPORT = ROOT / "build" / "exact_errors.json"


@dataclass
class Row:
    """A kernel and its errors."""

    variant: Variant
    library: Path
    worst: Worst

    def add(self, tool: BenchTool, chunk: Chunk) -> None:
        batch = self.variant.width > 1
        got = tool.run_kernel(self.library, chunk.cases, batch=batch, timeout=600)
        self.worst.add(chunk.cases, chunk.kinds, got, chunk.expected)


def all_roots(budget: float, model: str, target: Target) -> list[tuple[str, str]]:
    """Compilers and roots to be proved for a budget: each root, and each compiler for the first."""
    first, *others = roots_for(budget, model, target)
    return [*((compiler, first) for compiler in COMPILERS), *(("gcc", root) for root in others)]


def in_floats(single: Variant, target: Target) -> list[Variant]:
    """The batches of a kernel whose steps are made in floats, for each number of lanes."""
    return [
        single.in_lanes(width, lane_root=single["root"], interleave="s2", numbers="float")
        for width in float_lanes(single, target)
    ]


def rows_for(model: str, budgets: tuple[float, ...], target: Target) -> list[Row]:
    variants = [
        exact_variant(model, budget, compiler, root, target)
        for budget in budgets
        for compiler, root in all_roots(budget, model, target)
    ]
    coarsest = [exact_variant(model, budget, "clang", "", target) for budget in budgets]
    variants += [lanes for single in coarsest for lanes in in_floats(single, target)]
    moved = partial(conditioning, bench_tool(), model)
    return [
        Row(v, library, Worst(v.stepper.budget or 0.0, moved))
        for v, library in zip(variants, built(variants), strict=True)
    ]


def reference_chunk(tool: BenchTool, model: str) -> Chunk:
    """The reference, its answers computed from its doubles: the CSV files have decimals' errors."""
    reference = load_reference()
    kinds = tuple(f"reference {kind}" for kind in reference.kinds)
    return Chunk(0, reference.cases, kinds, expected_of(tool, reference.cases, model))


def hard_chunk(tool: BenchTool, model: str) -> Chunk:
    """The cases that once were the worst."""
    kinds, cases = load_hard()
    return Chunk(0, cases, kinds, expected_of(tool, cases, model))


def prove(model: str, count: int, budgets: tuple[float, ...], target: Target) -> list[Row]:
    """The errors of all kernels of a model."""
    tool = bench_tool()
    rows = rows_for(model, budgets, target)
    with ThreadPoolExecutor(2) as pool:
        known = (reference_chunk(tool, model), hard_chunk(tool, model))
        for chunk in (*known, *chunks(tool, model, count)):
            list(pool.map(lambda row, chunk=chunk: row.add(tool, chunk), rows))
    return rows


def table_line(row: Row) -> str:
    v, w = row.variant, row.worst
    verdict = "ok" if w.passed else "OVER"
    return (
        f"{v.model:13}{w.budget:<7.0e} {v['compiler']:6} {v['root']:5} x{v.width:<3} "
        f"{w.error:9.2e} {w.error / w.budget:7.2f} {w.over:7} {w.steep:6} of {w.count}  "
        f"{w.kind:28} {verdict}"
    )


def document(row: Row) -> dict[str, object]:
    """A row of the report: figures, and for each kind the worst case to the last bit."""
    v, w, tool = row.variant, row.worst, bench_tool()
    kinds: dict[str, dict[str, object]] = {}
    for kind, (error, over, case) in sorted(w.by_kind.items(), key=lambda k: -k[1][0]):
        kinds[kind] = {"max_rel_error": error, "over": over, "case": hexfloats(case)}
        if error > w.budget:
            kinds[kind]["one_ulp_moves_exact_by"] = conditioning(tool, v.model, case)
    figures = {"cases": w.count, "over": w.over, "steep": w.steep, "wrong_status": w.wrong_status}
    names = {"model": v.model, "budget": w.budget, "compiler": v["compiler"], "root": v["root"]}
    names["lanes"] = v.width
    worst = {"max_rel_error": w.error, "worst_kind": w.kind}
    return {"name": name_of(v), **names, **figures, **worst, "passed": w.passed, "kinds": kinds}


def prove_all(count: int, budgets: tuple[float, ...], models: tuple[str, ...]) -> list[Row]:
    """Prints the table as it comes and writes the report."""
    start, rows, target = time.monotonic(), [], read_host().target
    print(f"target {target.name}; largest relative error over the reference and {count} cases")
    print(
        "model        budget  compil root lanes     error  /budget    over  steep of cases, "
        "worst kind"
    )
    for model in models:
        rows += (fresh := prove(model, count, budgets, target))
        print("\n".join(map(table_line, fresh)), flush=True)
    report = {"target": target.name, "random_cases": count, "kernels": [document(r) for r in rows]}
    REPORT.parent.mkdir(exist_ok=True)
    REPORT.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    bad = [r for r in rows if not r.worst.passed]
    for row in bad:
        print(f"{name_of(row.variant)}:\n    {row.worst.line()}")
    took = time.monotonic() - start
    print(f"{len(rows) - len(bad)} of {len(rows)} kernels hold, {took:.0f} s; {REPORT}")
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=COUNT, help="random cases a model")
    parser.add_argument("--budgets", type=float, nargs="+", default=BUDGETS)
    parser.add_argument("--models", choices=MODELS, nargs="+", default=MODELS)
    parser.add_argument("--keep", action="store_true", help="add what fails to the kept hard cases")
    options = parser.parse_args()
    rows = prove_all(options.count, tuple(options.budgets), tuple(options.models))
    if options.keep:
        worst = [w for row in rows for w in row.worst.failing()]
        print(f"{keep(worst)} cases added to {EVIDENCE.hard_cases}")
    return 0 if all(row.worst.passed for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
