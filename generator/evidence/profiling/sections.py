"""Which part of a collision each line of a kernel belongs to, as the marks of its templates say.

Pre-loop: all until the first step. Impulse: slips' lengths, directions and impulses of a step, or
the rates of an exact one. Update: what the loop carries, its control, its ends. Post-loop: from the
impulses to the velocities that the caller gets. Helpers belong to whoever calls them.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...emission.marks import MARK

SECTIONS = ("pre-loop", "impulse", "update", "post-loop")


def sections_of(marked: str) -> list[str | None]:
    """The section of each line that is no mark, in order; None where the caller's counts."""
    found: list[str | None] = []
    section: str | None = None
    for line in marked.splitlines():
        if not line.lstrip().startswith(MARK):
            found.append(section)
            continue
        name, *rest = line.split()[1:]
        if name == "section":
            section = rest[0] if rest[0] in SECTIONS else None
    return found


def section_of(frames: Sequence[int], by_line: Sequence[str | None]) -> str | None:
    """The section of an instruction from the lines it was inlined through, innermost first."""
    for line in frames:
        if 0 < line <= len(by_line) and (section := by_line[line - 1]) is not None:
            return section
    return None
