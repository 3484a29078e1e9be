"""Closed forms that leave friction on the table away, timed beside exact kernels.

They answer another question: a row says what exactness costs. `bench/impacts/*/closed_forms` has
their C++, which compilers make lanes of.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..choice.cases import CaseSet
from ..choice.kernel import Built
from ..choice.workbench import Workbench
from ..evidence.timing.bench_tool import ROOT
from ..evidence.timing.plan import PlannedKernel
from ..evidence.timing.ratios import TimingResult
from ..toolchain.build import BuildJob, build


@dataclass(frozen=True)
class ClosedRow:
    """A closed form, timed in batches."""

    name: str
    beside: Built  # the exact kernel: compiler and flags are its own
    cases: CaseSet
    timing: TimingResult

    def document(self) -> dict[str, Any]:
        """The row as `gen bench --json` writes it."""
        kernel, timing = self.beside, self.timing
        question = kernel.variant.question
        return {
            "name": self.name,
            "target": question.target,
            "model": question.model,
            "impact": question.impact,
            "compiler": kernel.compiler.version,
            "flags": " ".join(kernel.flags),
            "cases": self.cases,
            "ns_per_collision": timing.ns,
            "ratio_to_baseline": timing.ratio,
            "ratio_ci": list(timing.ratio_ci),
        }


def closed_forms(tools: Workbench, kernel: Built) -> tuple[PlannedKernel, ...]:
    """Those of the impact, compiled as `kernel` is. KernelError where one does not compile."""
    return tuple(_planned(tools, kernel, path) for path in _sources(tools.tool.impact.folder))


def _sources(impact: str) -> list[Path]:
    return sorted((ROOT / "bench" / "impacts" / impact / "closed_forms").glob("*.cpp"))


def _planned(tools: Workbench, kernel: Built, path: Path) -> PlannedKernel:
    name = path.stem.replace("_", "-")
    texts = {path.name: path.read_text("utf-8")}
    made = build(BuildJob(name, texts, kernel.compiler, kernel.flags), tools.cache / "kernels")
    return PlannedKernel(name, made.path, batch=True)
