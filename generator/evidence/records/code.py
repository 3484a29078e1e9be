"""Hashes of kernels' code: what a figure depends on, and not what a kernel is called."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ...emission.environment import templates_folder
from ...emission.kernel_source import KernelSource
from ...registry.question import symbol_of
from ..timing.bench_tool import plain_code

SHAPING = (
    "mechanics",
    "impacts",
    "tableaus",
    "targets",
    "registry",
    "lowering",
    "steppers",
    "emission",
)


def digest(document: Any) -> str:
    """A short hash of plain values, whatever the order of their keys."""
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def key_of(*parts: object) -> str:
    """A short hash of plain values and of arrays, in this order."""
    found = hashlib.sha256()
    for part in parts:
        raw = part.tobytes() if isinstance(part, np.ndarray) else json.dumps(part).encode()
        found.update(len(raw).to_bytes(8, "little") + raw)
    return found.hexdigest()[:32]


def source_hash(source: KernelSource) -> str:
    """Hash of a kernel's code: not of comments, of layout or of its own name."""
    texts = []
    for text in (source.header, source.source, source.probe):
        plain = plain_code(text)
        plain = plain.replace('" "', "")  # a long name is written as two literals
        for name in (source.source_name, symbol_of(source.source_name)):
            plain = plain.replace(name, "KERNEL")
        texts.append(plain)
    return digest(texts)


@cache
def emission_hash() -> str:
    """Hash of all that texts follow from: where it is the same, none need be made again."""
    return hash_of_rooms(SHAPING)


def hash_of_rooms(rooms: Iterable[str]) -> str:
    """Hash of rooms of the generator and of the templates of kernels."""
    package = Path(__file__).parents[2]
    files = [path for room in rooms for path in (package / room).rglob("*")]
    files += [path for path in templates_folder().rglob("*") if path.parent.name != "report"]
    wanted = sorted(path for path in files if path.suffix in (".py", ".toml", ".j2", ".h"))
    return digest([[path.name, path.read_text("utf-8")] for path in wanted])
