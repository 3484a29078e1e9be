"""Cycles of recorded instructions on a CPU that need not be here, by llvm-mca."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ..errors import KernelError
from ..targets.target import Target
from .dataflow import ATTRIBUTES, NEEDS_LLVM, explicit
from .mca import require_mca, run_mca

REPLAYED = 3  # figures of another way to replay are not reused
_STRETCHES, _LENGTH = 8, 4_000  # of a longer run: as many stretches, so many instructions long
# Sixteen bytes of code a cycle are decoded, and an instruction of vectors takes about eight.
_CYCLES_TO_DECODE = 0.5
_OPTIONS = ("-iterations=1", "--all-views=false", "--summary-view")


@dataclass(frozen=True)
class Modelled:
    """Means for one collision on `cpu`, over the first cases of the mixed set."""

    cpu: str
    cycles: float
    instructions: float
    cases: int
    version: str  # of llvm-mca


def replayed_cycles(instructions: Sequence[str], target: Target, decoded: int = 0) -> float:
    """Cycles that the target needs for the instructions, one after the other as they ran.

    Of a long run some stretches, evenly spread, stand for all. Its pipeline is full all the time:
    branches are guessed rightly and memory is in the nearest cache. What x86-64 code stores is
    there for a load when a CPU has it there (toolchain.dataflow); of AArch64 code, at once. The
    pipeline stands still while `decoded` of the instructions are decoded, which llvm-mca takes for
    free: code that has outgrown the cache of decoded instructions is decoded in every turn.
    Raises KernelError.
    """
    mca, part = require_mca(), _stretches(instructions)
    options: tuple[str, ...] = _OPTIONS
    if target.row.arch == "x86_64":
        if mca.major < NEEDS_LLVM:
            raise KernelError(f"llvm-mca {mca.major} is too old; {NEEDS_LLVM} or later is needed")
        part, options = explicit(part), (ATTRIBUTES, *_OPTIONS)
    told = run_mca(mca, target, options, "\n".join(part) + "\n")
    found = re.search(r"^Total Cycles:\s+(\d+)", told, re.MULTILINE)
    if found is None:
        raise KernelError(f"llvm-mca {mca.major} does not say how many cycles it saw")
    return int(found[1]) * len(instructions) / len(part) + decoded * _CYCLES_TO_DECODE


def _stretches(instructions: Sequence[str]) -> list[str]:
    if len(instructions) <= _STRETCHES * _LENGTH:
        return list(instructions)
    every = len(instructions) / _STRETCHES
    starts = [round((n + 0.5) * every - _LENGTH / 2) for n in range(_STRETCHES)]
    return [line for start in starts for line in instructions[start : start + _LENGTH]]
