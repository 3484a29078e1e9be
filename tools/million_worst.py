"""A million random cases under the worst root estimates, for each committed kernel that uses one.

`.venv/bin/python tools/million_worst.py` builds the kernels of generated/ with estimates
that are off by all that their specification allows (verification/worst_estimates.py) and runs the
reference, the kept hard cases and a million random ones through each, in every pattern. It
prints the largest error: of exact kernels over the budget, of fixed steps against the scheme. Exit
status 1 where a kernel does not hold. The oracle's answers are those of million.py.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from generator.choice.folder import checked_selection, folders
from generator.emission.kernel_source import KernelSource, emit
from generator.evidence.timing.bench_tool import ROOT, BenchTool, Way
from generator.evidence.verification.worst_estimates import PATTERNS, Pattern, at_worst
from generator.impacts.ball_ball.evidence import MODELS
from generator.impacts.ball_ball.evidence.fixed_steps import euler_verdict
from generator.impacts.ball_ball.evidence.scene_cases import cases_for_scene
from generator.impacts.ball_ball.scene import find_scene
from generator.lowering.isa import estimates_in
from generator.registry.names import name_of
from generator.registry.variant import Variant
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.build import BuildJob, BuiltLibrary, build_many
from generator.toolchain.flags import compile_flags
from tests.support.exact_kernels import Worst, conditioning
from tests.support.kernels import CACHE, bench_tool, compiler_of
from tests.support.oracle_cache import Chunk, chunks, expected_of
from tools.million import COUNT, hard_chunk, reference_chunk


@dataclass
class Row:
    """A kernel and what was found of it."""

    variant: Variant
    library: Path
    worst: Worst
    pattern: str = ""
    failures: list[str] = field(default_factory=list)
    cases: int = 0
    largest: float = 0.0  # relative to the budget; fixed steps: m/s

    @property
    def exact(self) -> bool:
        return self.variant.stepper.budget is not None

    def add(self, tool: BenchTool, chunk: Chunk) -> None:
        self.cases += len(chunk.cases)
        for pattern in PATTERNS:
            got = tool.run_kernel(
                self.library,
                chunk.cases,
                batch=self.variant.width > 1,
                timeout=3600,
                way=Way(environment=pattern.environment()),
            )
            largest = (self._exact if self.exact else self._fixed)(tool, chunk, got, pattern)
            if largest > self.largest:
                self.largest, self.pattern = largest, pattern.name

    def _exact(self, _tool: BenchTool, chunk: Chunk, got: np.ndarray, pattern: Pattern) -> float:
        found = Worst(self.worst.budget, self.worst.moved)
        found.add(chunk.cases, chunk.kinds, got, chunk.expected)
        if not found.passed:
            self.failures.append(f"{pattern.name}: {found.line()}")
        return found.error / found.budget

    def _fixed(self, tool: BenchTool, chunk: Chunk, got: np.ndarray, pattern: Pattern) -> float:
        steps = self.variant.stepper.steps or 0
        if chunk.kinds[0].startswith("hard"):
            return 0.0  # cases for exact kernels: beyond what a scheme in doubles resolves
        scheme = _scheme_of(tool, chunk, self.variant.model, steps)
        verdict = euler_verdict(chunk.cases, got, scheme, chunk.expected, steps)
        if not verdict.passed:
            self.failures.append(f"{pattern.name}: {verdict.reason}")
        return verdict.max_abs_error

    def line(self) -> str:
        unit = "of the budget" if self.exact else "m/s from the scheme"
        verdict = "OVER" if self.failures else "ok"
        return (
            f"{name_of(self.variant):100} {self.largest:9.2e} {unit:20} {self.cases} cases  "
            f"{self.pattern:46} {verdict}"
        )


_SCHEMES: dict[tuple[int, str, int], np.ndarray] = {}


def _scheme_of(tool: BenchTool, chunk: Chunk, model: str, steps: int) -> np.ndarray:
    """The scheme in long double, kept for the chunk at hand."""
    key = (hash(chunk.cases.tobytes()), model, steps)
    if key not in _SCHEMES:
        _SCHEMES.clear()
        _SCHEMES[key] = tool.expect(chunk.cases, "euler", model, steps)
    return _SCHEMES[key]


def _in_scene(tool: BenchTool, chunk: Chunk, scene: str, model: str) -> Chunk:
    """The chunk's cases moved into a scene."""
    known = find_scene(scene)
    if known.unrestricted:
        return chunk
    cases = cases_for_scene(known, chunk.cases, model)
    return Chunk(chunk.first, cases, chunk.kinds, expected_of(tool, cases, model))


def committed(only: str) -> Iterator[tuple[Variant, KernelSource]]:
    """The kernels of generated/ whose text estimates roots and whose code runs here."""
    for folder in folders(ROOT / "generated"):
        selection = checked_selection(folder)
        for entry in selection.kernels if selection else ():
            variant = entry.variant
            if only not in entry.kernel or not read_host().runs(find_target(variant.target)):
                continue
            source = emit(variant)
            if estimates_in(source.source):
                yield variant, source


def rows_for(model: str, only: str) -> list[Row]:
    """The kernels of a model, built with estimates at their worst."""
    found = [(v, s) for v, s in committed(only) if v.model == model]
    jobs = []
    for variant, source in found:
        compiler = compiler_of(variant)
        texts = {"carom.h": source.header, "kernel.cpp": source.source, "probe.cpp": source.probe}
        flags = compile_flags(variant, compiler, find_target(variant.target))
        jobs.append(at_worst(BuildJob(name_of(variant), texts, compiler, flags)))
    moved = partial(conditioning, bench_tool(), model)
    rows = []
    for (variant, _), library in zip(found, build_many(jobs, CACHE), strict=True):
        assert isinstance(library, BuiltLibrary), library
        rows.append(Row(variant, library.path, Worst(variant.stepper.budget or 0.0, moved)))
    return rows


def run(model: str, count: int, only: str) -> list[Row]:
    tool, rows = bench_tool(), rows_for(model, only)
    if not rows:
        return []
    scenes = {row.variant.scene for row in rows}
    known = (reference_chunk(tool, model), hard_chunk(tool, model))
    for chunk in (*known, *chunks(tool, model, count)):
        for scene in sorted(scenes):
            moved = _in_scene(tool, chunk, scene, model)
            mine = [row for row in rows if row.variant.scene == scene]
            if any(not row.exact for row in mine) and not moved.kinds[0].startswith("hard"):
                _scheme_of(tool, moved, model, 1000)
            with ThreadPoolExecutor(2) as pool:
                list(pool.map(lambda row, moved=moved: row.add(tool, moved), mine))
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=COUNT, help="random cases a model")
    parser.add_argument("--models", choices=MODELS, nargs="+", default=MODELS)
    parser.add_argument("--only", default="", help="kernels whose name has this in it")
    options = parser.parse_args()
    start, rows = time.monotonic(), []
    for model in options.models:
        rows += (fresh := run(model, options.count, options.only))
        print("\n".join(row.line() for row in fresh), flush=True)
    for row in rows:
        for failure in row.failures[:2]:
            print(f"{name_of(row.variant)}:\n    {failure}")
    held = sum(not row.failures for row in rows)
    print(f"{held} of {len(rows)} kernels hold, {time.monotonic() - start:.0f} s")
    return 0 if rows and held == len(rows) else 1


if __name__ == "__main__":
    sys.exit(main())
