"""Random cases with the oracle's answers, computed once and kept in build/cache/oracle.

A chunk's answers are found by its cases, the model and the sources of the oracle, so a change in
any of them computes anew.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from generator.evidence.timing.bench_tool import ROOT, BenchTool
from generator.evidence.verification.errors import Array

CACHE = ROOT / "build" / "cache" / "oracle"
CHUNK = 50_000
MILLION_SEED = 1_000_003


@dataclass(frozen=True)
class Chunk:
    """Some of the cases: rows of 24, a kind each, and what must come out, in rows of 14."""

    first: int
    cases: Array
    kinds: tuple[str, ...]
    expected: Array


@cache
def _oracle_hash() -> str:
    digest = hashlib.sha256()
    for path in sorted((ROOT / "tests" / "oracle" / "ball_ball").glob("*.h")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def expected_of(tool: BenchTool, cases: Array, model: str) -> Array:
    """The oracle's answers, from the cache where they are known."""
    digest = hashlib.sha256(f"{_oracle_hash()} {model} ".encode() + cases.tobytes())
    path = CACHE / f"{model}-{digest.hexdigest()[:24]}.f64"
    if path.is_file():
        return np.fromfile(path).reshape(len(cases), tool.columns.expected_width)
    expected = tool.expect(cases, "exact", model)
    CACHE.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=CACHE, delete=False) as file:
        file.write(expected.tobytes())
    os.replace(file.name, path)
    return expected


def chunks(tool: BenchTool, model: str, count: int, seed: int = MILLION_SEED) -> Iterator[Chunk]:
    """`count` random cases, all kinds in turn, in chunks that differ in their seed."""
    for number, first in enumerate(range(0, count, CHUNK)):
        made = tool.make_cases(seed + number, min(CHUNK, count - first), mixed=False)
        yield Chunk(first, made.rows, made.kinds, expected_of(tool, made.rows, model))


def kept_bytes(folder: Path = CACHE) -> int:
    """How much the cache takes on disk."""
    return sum(path.stat().st_size for path in folder.glob("*.f64"))
