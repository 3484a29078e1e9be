"""Instruction sets that batches run on: one row and one file of templates/lanes each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..targets.target import Target

Precision = Literal["double", "float"]  # of the numbers in lanes


@dataclass(frozen=True)
class InstructionSet:
    """Lanes of one instruction set; `name` is its file in templates/lanes."""

    name: str
    doubles: int  # in a vector; of floats there are twice as many, in more than one lane
    arch: str  # the empty one is any
    needs: frozenset[str]
    text: str

    def on(self, target: Target) -> bool:
        """Does the target have it?"""
        return self.arch in ("", target.row.arch) and self.needs <= target.features

    def lanes(self, precision: Precision) -> int:
        """How many numbers a vector holds."""
        return 2 * self.doubles if precision == "float" and self.doubles > 1 else self.doubles


INSTRUCTION_SETS: tuple[InstructionSet, ...] = (
    InstructionSet("scalar", 1, "", frozenset(), "one number"),
    InstructionSet("sse2", 2, "x86_64", frozenset({"sse2", "ssse3"}), "SSE2, and SSSE3's shuffle"),
    InstructionSet("avx2", 4, "x86_64", frozenset({"avx2"}), "AVX2"),
    InstructionSet("avx512", 8, "x86_64", frozenset({"avx512f", "avx512dq"}), "AVX-512"),
    InstructionSet("neon", 2, "aarch64", frozenset({"neon"}), "NEON"),
    InstructionSet("simd128", 2, "wasm32", frozenset({"simd128"}), "WebAssembly's SIMD"),
)


def sets_of(target: Target) -> tuple[InstructionSet, ...]:
    """The instruction sets that a target has, the narrowest first."""
    return tuple(sorted((s for s in INSTRUCTION_SETS if s.on(target)), key=lambda s: s.doubles))


def widths_of(target: Target, precision: Precision = "double") -> tuple[int, ...]:
    """Numbers of lanes that a target has vectors for, 1 among them."""
    return tuple(s.lanes(precision) for s in sets_of(target))


def set_for(target: Target, width: int, precision: Precision = "double") -> InstructionSet:
    """The target's instruction set of that many lanes. ValueError names the widths there are."""
    for candidate in sets_of(target):
        if candidate.lanes(precision) == width:
            return candidate
    there = ", ".join(f"x{lanes}" for lanes in widths_of(target, precision))
    raise ValueError(f"{target.name} has no vectors of {width} {precision}s; it has {there}")
