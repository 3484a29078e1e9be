"""What is to be timed, as carom_bench reads it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PlannedKernel:
    """A shared library to be timed. `batch`: throughput of its batch function."""

    name: str
    library: Path
    batch: bool = False
    latency: bool = False  # time it fed by its own last outcome too


@dataclass(frozen=True)
class TimingPlan:
    """Kernels to be timed against each other on the same cases, in one process.

    Each round times a block of each kernel, of the baseline twice. It ends after `rounds` rounds or
    `seconds` seconds, whichever comes first, but not before one round.
    """

    cases: Array  # rows of 24; at least 4096 keep a branch predictor from learning them
    kernels: tuple[PlannedKernel, ...]
    baseline: str  # name of one of the kernels
    seed_cases: Array | None = None
    rounds: int = 200
    seconds: float = 60.0
    block_ms: float = 1.0

    def __post_init__(self) -> None:
        names = [kernel.name for kernel in self.kernels]
        if len(set(names)) != len(names):
            raise ValueError("two kernels of a plan have the same name")
        if self.baseline not in names:
            raise ValueError(f"the baseline '{self.baseline}' is not among the kernels")

    def document(self, cases: Path, seed_cases: Path | None) -> dict[str, object]:
        """The plan as JSON, with the files that hold its cases."""
        return {
            "cases": str(cases),
            "seed_cases": None if seed_cases is None else str(seed_cases),
            "kernels": [
                {
                    "name": kernel.name,
                    "library": str(kernel.library),
                    "batch": kernel.batch,
                    "latency": kernel.latency,
                }
                for kernel in self.kernels
            ],
            "baseline": [kernel.name for kernel in self.kernels].index(self.baseline),
            "rounds": self.rounds,
            "seconds": self.seconds,
            "block_ms": self.block_ms,
        }
