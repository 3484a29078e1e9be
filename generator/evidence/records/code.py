"""Hashes of kernels' code: what a figure depends on, and not what a kernel is called."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Sequence
from typing import Any

from ...emission.kernel_source import KernelSource
from ...registry.question import symbol_of

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


def digest(document: Any) -> str:
    """A short hash of plain values, whatever the order of their keys."""
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def source_hash(source: KernelSource) -> str:
    """Hash of a kernel's code: not of comments, of layout or of its own name."""
    texts = []
    for text in (source.header, source.source, source.probe):
        plain = " ".join(_COMMENT.sub(" ", text).split())
        plain = plain.replace('" "', "")  # a long name is written as two literals
        for name in (source.source_name, symbol_of(source.source_name)):
            plain = plain.replace(name, "KERNEL")
        texts.append(plain)
    return digest(texts)


def compiled_hash(source: KernelSource, compiler: str, flags: Sequence[str]) -> str:
    """Hash of code, compiler (its version) and flags."""
    return digest([source_hash(source), [compiler, *flags]])
