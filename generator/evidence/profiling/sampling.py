"""Where a kernel's time goes: the program counter sampled by a timer, mapped to sections.

The kernel is compiled with line tables (-g), which change no instruction. An out-of-order core is
busy in several sections at once; a sample counts for the one whose instruction is found waiting.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ...emission.environment import environment
from ...emission.kernel_source import KernelSource
from ...emission.marks import without_marks
from ...errors import KernelError
from ...toolchain.build import build_library
from ...toolchain.compilers import Compiler
from ...toolchain.process import run
from ..verification.errors import Array
from .isolated import call_isolated
from .sections import SECTIONS, section_of, sections_of

_HEADER = re.compile(r"^0x[0-9a-f]+$")
_FRAME = re.compile(r"(?:.*/)?kernel\.cpp:(\d+)")
_BACK = 64  # bytes that an instruction without a line may be away from one that has one
_FLAGS = ("-std=c++17", "-O2")


@dataclass(frozen=True)
class Sampled:
    """Shares of the samples taken in the kernel's library, by section; they add up to 1."""

    shares: Mapping[str, float]
    unknown: float  # instructions with no line of a section
    samples: int
    counters: Mapping[str, float]  # a collision, by the hardware; empty where there are none
    no_counters: str  # why


def sample(
    source: KernelSource,
    compiler: Compiler,
    flags: tuple[str, ...],
    cases: Array,
    seconds: float,
    cache: Path,
) -> Sampled:
    """Run a kernel on rows of cases for a while. Raises KernelError where that fails."""
    if shutil.which("addr2line") is None:
        raise KernelError("sections: no addr2line (apt-get install binutils)")
    files = {**source.files, "kernel.cpp": without_marks(source.marked)}
    kernel = build_library(files, (), compiler, (*flags, "-g"), cache, "sampled kernel")
    row = source.variant.question.row
    text = (
        environment()
        .get_template("sampling/sample.cpp.j2")
        .render(
            abi=row.functions, parameters=len(row.columns.parameters), width=len(row.columns.case)
        )
    )
    sampler = build_library({"sample.cpp": text}, (), compiler, _FLAGS, cache, "sampler")
    taken = call_isolated(
        "carom_sample", sampler.path, cases, 300 + 5 * seconds, kernel.path.resolve(), seconds
    )
    at = {int(offset): int(count) for offset, count in taken["at"]}
    if not at:
        raise KernelError("sections: no sample fell into the kernel")
    by_line = sections_of(source.marked)
    totals = dict.fromkeys(SECTIONS, 0)
    unknown = 0
    for offset, section in _sections_at(kernel.path, list(at), by_line).items():
        if section is None:
            unknown += at[offset]
        else:
            totals[section] += at[offset]
    whole = sum(at.values())
    return Sampled(
        shares={name: count / whole for name, count in totals.items()},
        unknown=unknown / whole,
        samples=whole,
        counters=taken["counters"],
        no_counters=taken["no_counters"],
    )


def _sections_at(
    library: Path, offsets: Sequence[int], by_line: Sequence[str | None]
) -> dict[int, str | None]:
    """The section of each instruction; of one without a line, that of the nearest one before it.

    Clang gives no line to instructions that it made out of several statements.
    """
    frames = _frames(library, offsets)
    found = {offset: section_of(frames.get(offset, ()), by_line) for offset in offsets}
    lost = [offset for offset, section in found.items() if section is None]
    nearby = sorted({offset - back for offset in lost for back in range(1, _BACK + 1)})
    around = _frames(library, nearby) if nearby else {}
    for offset in lost:
        before = (section_of(around.get(offset - n, ()), by_line) for n in range(1, _BACK + 1))
        found[offset] = next((section for section in before if section is not None), None)
    return found


def _frames(library: Path, offsets: Iterable[int]) -> dict[int, list[int]]:
    """Lines of kernel.cpp that each address was inlined through, innermost first."""
    addresses = "".join(f"{offset:#x}\n" for offset in offsets if offset > 0)
    done = run(["addr2line", "-a", "-i", "-e", str(library)], 60, text=addresses)
    if done.code != 0:
        raise KernelError(f"addr2line: {done.first_error}")
    found: dict[int, list[int]] = {}
    current: list[int] = []
    for line in done.output.splitlines():
        if _HEADER.match(line):
            current = found.setdefault(int(line, 16), [])
        elif (frame := _FRAME.match(line)) is not None:
            current.append(int(frame[1]))
    return found
