"""Operations in C++ text: how much of a kernel's arithmetic a scene leaves in its source.

A static count of what stands in the text, not of what runs: a loop's body counts once.
"""

from __future__ import annotations

import re
from dataclasses import replace

from .counts import OperationCounts

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_STRING = re.compile(r'"[^"\n]*"')
_DIRECTIVE = re.compile(r"^\s*#[^\n]*", re.MULTILINE)
_CONSTANT = re.compile(r"\bconstexpr\b[^;{]*;")  # the compiler's work, not the kernel's
_OPERAND = r"[\w)\]]"
_KINDS = {
    "fma": re.compile(r"\bfma\("),
    "sqrt": re.compile(r"\bsqrt\("),
    "estimate": re.compile(r"\brough_\w+\(|_mm_\w*rsqrt\w*\(|\bvrsqrt\w+\("),
    "select": re.compile(r"\bselect\(|\?"),
    "add": re.compile(rf"(?<={_OPERAND})\s[+-]\s|[+-]= "),
    "mul": re.compile(rf"(?<={_OPERAND})\s\*\s(?=[\w(-])"),
    "div": re.compile(rf"(?<={_OPERAND})\s/\s"),
    "compare": re.compile(r" (?:[<>]=?|==|!=) |\bf?(?:max|min)\(|\bin_range\(p"),
}


def operations_in(text: str) -> OperationCounts:
    """Operations in a source text, comments, strings and directives left out."""
    for ignored in (_COMMENT, _STRING, _DIRECTIVE, _CONSTANT):
        text = ignored.sub(" ", text)
    found = {kind: len(pattern.findall(text)) for kind, pattern in _KINDS.items()}
    return replace(OperationCounts(), **found)
