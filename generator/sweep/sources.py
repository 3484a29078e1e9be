"""Hashes of kernels' code: what a figure depends on, and not what a kernel is called."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path

from ..choice.store import key_of
from ..choice.workbench import Candidate
from ..emission.environment import templates_folder
from ..evidence.records.code import compiled_hash

SHAPING = ("impacts", "tableaus", "targets", "registry", "lowering", "steppers", "emission")


def candidate_hash(candidate: Candidate) -> str:
    """Hash of code, compiler and flags."""
    return compiled_hash(candidate.source, candidate.compiler.version, candidate.flags)


@cache
def emission_hash() -> str:
    """Hash of all that texts follow from: where it is the same, none need be made again."""
    return hash_of_rooms(SHAPING)


def hash_of_rooms(rooms: Iterable[str]) -> str:
    """Hash of rooms of the generator and of the templates of kernels."""
    package = Path(__file__).parents[1]
    files = [path for room in rooms for path in (package / room).rglob("*")]
    files += [path for path in templates_folder().rglob("*.j2") if path.parent.name != "report"]
    wanted = sorted(path for path in files if path.suffix in (".py", ".toml", ".j2"))
    return key_of(*([path.name, path.read_text("utf-8")] for path in wanted))
