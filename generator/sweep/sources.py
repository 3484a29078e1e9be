"""Hashes of kernels' code: what a figure depends on, and not what a kernel is called."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from generator.choice.store import key_of
from generator.choice.workbench import Candidate
from generator.emission.environment import templates_folder
from generator.emission.kernel_source import KernelSource
from generator.sweep.record import digest
from generator.variants.names import symbol_of

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_ROOMS = ("mechanics", "scenes", "steppers", "targets", "variants", "lowering", "emission")


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


def candidate_hash(candidate: Candidate) -> str:
    """Hash of code, compiler and flags."""
    compiled = [candidate.compiler.version, *candidate.flags]
    return digest([source_hash(candidate.source), compiled])


@cache
def emission_hash() -> str:
    """Hash of all that texts follow from: where it is the same, none need be made again."""
    return hash_of_rooms(_ROOMS)


def hash_of_rooms(rooms: Iterable[str]) -> str:
    """Hash of rooms of the generator and of the templates of kernels."""
    package = Path(__file__).parents[1]
    files = [path for room in rooms for path in (package / room).rglob("*")]
    files += [path for path in templates_folder().rglob("*.j2") if path.parent.name != "report"]
    wanted = sorted(path for path in files if path.suffix in (".py", ".toml", ".j2"))
    return key_of(*([path.name, path.read_text("utf-8")] for path in wanted))
