"""Kernels under the worst root estimates that the instructions' specifications allow.

What a CPU's estimate of 1 / sqrt(x) is differs from maker to maker, within the documented bound. So
a kernel that holds on one CPU need not hold on another. In a build for verification alone the
instructions are replaced by functions (bench/worst_estimates.h) that are off by the whole bound, in
a pattern of signs that is the same for the same input. NEON's estimates are defined to the bit,
and WebAssembly has none: what is so in one place is so everywhere.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from ...errors import KernelError
from ...lowering.isa import estimates_in
from ...places import sources
from ...toolchain.build import BuildJob

HEADER = "worst_estimates.h"
VARIABLE = "CAROM_WORST_ESTIMATES"  # what the header reads a pattern from
_NO_CONTRACTION = "-ffp-contract=off"
_HASHED_BIT, _SEGMENT_BIT = 63, 46  # of a product of bits; of a mantissa: 64 pieces of an octave


@dataclass(frozen=True)
class Pattern:
    """Shares of the bound that estimates are off by, for either half of all inputs."""

    name: str
    one: float
    other: float
    hashed: bool = False  # halves by a hash of the bits, else by pieces of an octave

    def environment(self) -> dict[str, str]:
        """What a process needs to run a kernel under this pattern."""
        bit = _HASHED_BIT if self.hashed else _SEGMENT_BIT
        return {VARIABLE: f"{self.one!r} {self.other!r} {int(self.hashed)} {bit}"}


# Where it is constant an error scales friction; where its sign changes it is rough, as a table's
# is. An error within the bound may send the control of steps another way than the bound itself.
PATTERNS: tuple[Pattern, ...] = (
    Pattern("all too large", 1.0, 1.0),
    Pattern("all too small", -1.0, -1.0),
    Pattern("all too large by 2/3 of it", 2 / 3, 2 / 3),
    Pattern("all too small by 1/3 of it", -1 / 3, -1 / 3),
    Pattern("too large or too small by pieces of an octave", 1.0, -1.0),
    Pattern("too large or too small by a hash of the input", 1.0, -1.0, hashed=True),
)


def header_text() -> str:
    """The header that takes the instructions' place."""
    return (sources() / "bench" / HEADER).read_text("utf-8")


def at_worst(job: BuildJob) -> BuildJob:
    """The same library with all estimates replaced.

    Raises KernelError where a text has one that the header does not replace.
    """
    header = header_text()
    wanted = frozenset().union(*(estimates_in(text) for text in job.sources.values()))
    missing = sorted(n for n in wanted if not re.search(rf"^#define {n}\(", header, re.MULTILINE))
    if missing:
        raise KernelError(f"bench/{HEADER}: nothing in place of {missing[0]}; expected a #define")
    texts: Mapping[str, str] = {**job.sources, HEADER: header}
    flags = job.flags
    if _NO_CONTRACTION in flags:  # rounded alike at any level; a lower one compiles in less time
        flags = tuple("-O1" if flag == "-O3" else flag for flag in flags)
    return replace(job, sources=texts, flags=(*flags, "-include", HEADER))
