"""The proof of the cushion's exact kernels, the long part: a million random cases a model.

`.venv/bin/python tools/cushion_million.py` runs the kernel of every budget, by call and in a batch,
in GCC and Clang, over random cases of all kinds and prints the largest error of each. Exit status 1
where a budget does not hold. The oracle answers in double, whose answers differ from those in long
double by less than 1e-13; what seems to be over is asked again in long double.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from generator.errors import KernelError
from generator.evidence.timing.bench_tool import BenchTool, CaseSet
from generator.evidence.verification.errors import Array
from generator.impacts.ball_cushion.columns import COLUMNS
from generator.impacts.ball_cushion.evidence import EVIDENCE
from tests.support.cushion import cushion_tool, cushion_variant
from tests.support.kernels import build_all

CHUNK, SEED = 43_000, 1_000_003  # as many of each kind
COMPILERS, MODELS, BUDGETS = ("gcc", "clang"), ("clamped", "printed"), (1e-3, 1e-6, 1e-9)


@dataclass
class Row:
    """A kernel and its errors."""

    model: str
    budget: float
    compiler: str
    batch: bool
    library: Path
    worst: float = 0.0
    kind: str = ""
    over: int = 0
    kinds_over: set[str] = field(default_factory=set)

    def add(self, tool: BenchTool, made: CaseSet, expected: Array) -> None:
        measure = EVIDENCE.measure
        got = tool.run_kernel(self.library, made.rows, batch=self.batch, timeout=600)
        error = measure.errors_of(made.rows, got, expected).relative
        error[got[:, COLUMNS.status] != expected[:, COLUMNS.status]] = np.inf
        allowed = np.maximum(self.budget, measure.rounding_of(made.rows))
        for i in np.flatnonzero(error > allowed):
            case = slice(int(i), int(i) + 1)
            exact = tool.expect(made.rows[case], "exact", self.model)
            if not measure.errors_of(made.rows[case], got[case], exact).relative[0] <= allowed[i]:
                self.over += 1
                self.kinds_over.add(made.kinds[i])
        last = int(error.argmax())
        if error[last] > self.worst:
            self.worst, self.kind = float(error[last]), made.kinds[last]

    def line(self) -> str:
        way = "batch" if self.batch else "call"
        found = f"{self.model:8} {self.budget:<7.0e} {self.compiler:6} {way:6}{self.worst:9.2e}"
        more = f", of {', '.join(sorted(self.kinds_over))}" if self.over else ""
        return f"{found} {self.over:6} over   {self.kind}{more}"


def rows_for(model: str, budgets: list[float]) -> list[Row]:
    asked = [(budget, compiler) for budget in budgets for compiler in COMPILERS]
    libraries = build_all(
        [cushion_variant(model=model, budget=b, stepper="series", compiler=c) for b, c in asked]
    )
    rows = []
    for (budget, compiler), library in zip(asked, libraries, strict=True):
        if isinstance(library, KernelError):
            raise library
        rows += [Row(model, budget, compiler, batch, library.path) for batch in (False, True)]
    return rows


def prove(tool: BenchTool, model: str, budgets: list[float], count: int) -> list[Row]:
    rows = rows_for(model, budgets)
    for number, first in enumerate(range(0, count, CHUNK)):
        made = tool.make_cases(SEED + number, min(CHUNK, count - first), mixed=False)
        expected = tool.expect(made.rows, "screen", model)
        for row in rows:
            row.add(tool, made, expected)
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=1_000_000, help="random cases a model")
    parser.add_argument("--budgets", type=float, nargs="+", default=list(BUDGETS))
    parser.add_argument("--models", choices=MODELS, nargs="+", default=list(MODELS))
    options = parser.parse_args()
    tool, holds = cushion_tool(), True
    print(f"largest error of |v| in {options.count} random cases, and how many are over the budget")
    for model in options.models:
        for row in prove(tool, model, options.budgets, options.count):
            print(row.line(), flush=True)
            holds = holds and row.over == 0
    return 0 if holds else 1


if __name__ == "__main__":
    sys.exit(main())
