"""The compilers of this machine, by the codes of the axis `compiler`."""

from __future__ import annotations

import platform
import re
import shutil
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ..errors import KernelError
from ..targets.target import Target, targets
from .process import run

_SUFFIXES = [f"-{major}" for major in range(29, 8, -1)] + [""]  # newest first
_PACKAGES = {"gcc": "g++", "clang": "clang-19", "clangold": "clang"}
_QUICK = 20.0  # seconds for a question to a compiler


@dataclass(frozen=True)
class Compiler:
    """A C++ compiler that was found and answered."""

    code: str  # "gcc", "clang" or "clangold"
    path: str
    version: str  # the first line of --version
    major: int

    @property
    def is_clang(self) -> bool:
        return self.code != "gcc"


@dataclass(frozen=True)
class March:
    """How a compiler is told a target's CPU."""

    flags: tuple[str, ...]
    used: str  # what -march was given
    wanted: str

    @property
    def note(self) -> str:
        """Empty where the compiler knows the CPU, otherwise what it was told instead."""
        return (
            "" if self.used == self.wanted else f"-march={self.used}, as {self.wanted} is unknown"
        )


def _probe(code: str, name: str) -> Compiler | None:
    path = shutil.which(name)
    if path is None:
        return None
    try:
        told = run([path, "--version"], _QUICK)
    except KernelError:
        return None
    first = told.output.splitlines()[0].strip() if told.code == 0 and told.output else ""
    number = re.search(r"(\d+)\.\d+(\.\d+)?", first)
    # On some systems g++ is Clang by another name.
    if number is None or ("clang" in first.lower()) != (code != "gcc"):
        return None
    return Compiler(code, path, first, int(number[1]))


def _newest(code: str, stem: str) -> Compiler | None:
    """The highest version among `stem-NN` and plain `stem`, the first of equals."""
    found = [c for suffix in _SUFFIXES if (c := _probe(code, stem + suffix)) is not None]
    return max(found, key=lambda c: c.major, default=None)


@cache
def find_compilers() -> tuple[Compiler, ...]:
    """The compilers there are, in the order of the axis; each code at most once."""
    newest = _newest("clang", "clang++")
    default = _probe("clangold", "clang++")
    if newest is not None and default is not None and default.version == newest.version:
        default = None
    return tuple(c for c in (_newest("gcc", "g++"), newest, default) if c is not None)


@cache
def cross_compilers(arch: str) -> tuple[Compiler, ...]:
    """Those that compile and link for another architecture: GCC's own for it, and Clang."""
    gcc = _newest("gcc", f"{arch}-linux-gnu-g++")
    if gcc is None:
        return ()  # Clang takes the linker and the system's headers from it
    return (gcc, *(c for c in find_compilers() if c.code == "clang"))


def compilers_for(target: Target) -> tuple[Compiler, ...]:
    """The compilers for a target's architecture, whichever machine this is."""
    if target.row.arch == platform.machine():
        return find_compilers()
    return cross_compilers(target.row.arch)


def emulator_for(target: Target) -> tuple[str, ...] | None:
    """The command before a program of the target's architecture; empty where none is needed.

    None where there is none.
    """
    arch = target.row.arch
    if arch == platform.machine():
        return ()
    qemu = shutil.which(f"qemu-{arch}")
    return None if qemu is None else (qemu, "-L", f"/usr/{arch}-linux-gnu")


def missing(found: Iterable[Compiler]) -> str:
    """What was not found and the Debian package that brings it; empty where nothing is missing."""
    codes = {c.code for c in found}
    absent = [code for code in _PACKAGES if code not in codes]
    return ", ".join(f"no {code} (apt-get install {_PACKAGES[code]})" for code in absent)


def _triple(compiler: Compiler, arch: str) -> tuple[str, ...]:
    """What makes a compiler emit code for another architecture than this machine's."""
    if arch == platform.machine():
        return ()
    return (f"--target={arch}-linux-gnu",) if compiler.is_clang else ()


def _is_cross(compiler: Compiler, arch: str) -> bool:
    return Path(compiler.path).name.startswith(f"{arch}-linux-gnu-")


@cache
def accepts_march(compiler: Compiler, march: str, arch: str = "") -> bool:
    """Does the compiler know this name? It is asked once a process."""
    flags = _triple(compiler, arch or platform.machine())
    question = [compiler.path, *flags, f"-march={march}", "-fsyntax-only", "-x", "c++", "-"]
    try:
        return run(question, _QUICK).code == 0
    except KernelError:
        return False


def march_flags(compiler: Compiler, target: Target) -> March:
    """The target's -march, or the nearest one that the compiler knows.

    GCC 12 does not know znver4 and znver5, Clang 14 does not know znver4: then it is GCC's fallback
    of the target's row, then the ancestors in order. Raises KernelError where none is known.
    """
    row, arch = target.row, target.row.arch
    wanted = [row.march]
    if not compiler.is_clang and row.march_gcc_fallback is not None:
        wanted.append(row.march_gcc_fallback)
    wanted += [targets()[name].row.march for name in target.ancestors]
    if compiler.is_clang or arch == platform.machine() or _is_cross(compiler, arch):
        for march in wanted:
            if accepts_march(compiler, march, arch):
                flags = (*_triple(compiler, arch), f"-march={march}")
                return March(flags, march, row.march)
    raise KernelError(
        f"{compiler.code} ({compiler.version}) cannot compile for {target.name}: it knows none of "
        + ", ".join(wanted)
    )
