"""Cycles of recorded instructions on a CPU that need not be here, by llvm-mca."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from generator.errors import KernelError
from generator.targets.target import Target
from generator.toolchain.mca import require_mca, run_mca

_AT_ONCE = 60_000  # instructions; llvm-mca takes more than twice as long for twice as many
_OPTIONS = ("-iterations=1", "--all-views=false", "--summary-view")


@dataclass(frozen=True)
class Modelled:
    """Means for one collision on `cpu`, over the first cases of the mixed set."""

    cpu: str
    cycles: float
    instructions: float
    cases: int
    steps: int | None  # fixed steps that were recorded of each; figures are for all of them
    version: str  # of llvm-mca


def replayed_cycles(instructions: Sequence[str], target: Target) -> int:
    """Cycles that the target needs for the instructions, one after the other as they ran.

    Its pipeline is full all the time: branches are guessed rightly, memory is in the nearest cache
    and what was just stored is there at once. Raises KernelError.
    """
    cycles = 0
    for start in range(0, len(instructions), _AT_ONCE):
        text = "\n".join(instructions[start : start + _AT_ONCE]) + "\n"
        told = run_mca(require_mca(), target, _OPTIONS, text)
        found = re.search(r"^Total Cycles:\s+(\d+)", told, re.MULTILINE)
        if found is None:
            raise KernelError(f"llvm-mca {require_mca().major} does not say how many cycles it saw")
        cycles += int(found[1])
    return cycles
