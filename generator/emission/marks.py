"""Places in a kernel's text that tools look for: lines `//@ NAME ARGUMENT...` of the templates.

A kernel is emitted without them. Tools that count, sample or model take `KernelSource.marked`, the
same text with these lines, and put their own in place of each:

    begin REGION [CONDITION]   a region of a loop's body begins, where the condition holds
    end REGION [CONDITION]     it ends
    section NAME               all up to the next such mark belongs to a section of a collision
                               (evidence/profiling/sections.py), or to its `caller`
    rare                       a block that hardly ever runs: a guess was refused
    evaluation                 the rates of the slips are evaluated
    root                       a helper that makes roots begins
    tier NAME [STEPS]          it is decided which steps a collision takes
    declare DECLARATION        what a CONDITION names, as it stands
"""

from __future__ import annotations

from collections.abc import Callable

MARK = "//@ "


def without_marks(text: str) -> str:
    """The text as it is emitted."""
    return filled(text, lambda _name, *_arguments: "")


def filled(text: str, line_for: Callable[..., str]) -> str:
    """The text with `line_for(name, *arguments)` in place of each mark; no line where empty."""
    lines = []
    for line in text.splitlines(keepends=True):
        if not line.lstrip().startswith(MARK):
            lines.append(line)
        elif own := line_for(*line.split()[1:]):
            lines.append(own + "\n")
    return "".join(lines)


def only_where(condition: tuple[str, ...], statement: str) -> str:
    """A statement under the condition that a mark gives, if it gives one."""
    return f"if constexpr ({condition[0]}) {statement}" if condition else statement
