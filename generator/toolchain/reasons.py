"""Why a program failed: the first real reason in what CMake, compilers, linkers or pip print."""

from __future__ import annotations

import re
from collections.abc import Iterable

_MOST = 300  # characters
_CMAKE = re.compile(r"CMake Error at .*:\d+ \(\w+\):$")
_RAISED = "Traceback (most recent call last):"
# What a linker or the system says in lines without the word; a summary comes after it.
_CAUSE = re.compile(
    r"(?i:\berror:)|undefined reference to|multiple definition of|cannot find -l"
    r"|No space left on device|[Cc]annot allocate memory|virtual memory exhausted"
    r"|[Pp]ermission denied|command not found|Read-only file system|^E: |connection broken"
)
_SUMMARY = re.compile(
    r"collect2: error|linker command failed|ninja: |\bmake(\[\d+\])?: \*\*\*|subprocess-exited"
    r"|^error: command .* failed|^FAILED: "
)


def reason_in(text: str) -> str:
    """One line with the first reason, else the first line there is; empty where there is none."""
    lines = [line for line in text.splitlines() if line.strip()]
    for number, line in enumerate(lines):
        if _CMAKE.match(line):
            return _shown(_of_cmake(line, lines[number + 1 :]))
        if line.strip() == _RAISED:
            return _shown(lines[-1])
        if _is_cause(line):
            return _shown(line)
    return _shown(next((line for line in lines if not _SUMMARY.search(line)), text))


def _is_cause(line: str) -> bool:
    return _CAUSE.search(line) is not None and not _SUMMARY.search(line)


def _of_cmake(head: str, rest: Iterable[str]) -> str:
    """The first sentence of CMake's message, and the reason in what it cites."""
    words: list[str] = []
    cited = ""
    for line in rest:
        if not line.startswith(" "):
            break
        if not words or not words[-1].endswith("."):
            words.append(line.strip())
        elif _is_cause(line):
            cited = line.strip()
            break
    where = head.removeprefix("CMake Error at ").rpartition(" (")[0]
    return f"{where}: {' '.join(words)} {cited}"


def _shown(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= _MOST else f"{line[: _MOST - 4]} ..."
