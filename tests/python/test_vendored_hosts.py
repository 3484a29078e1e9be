"""A vendored folder in the builds of others: exports, line ends, macros of other headers."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from vendored import PAIRS, files_for, request_for, vendored

from generator.vendoring.foreign_macros import FOREIGN_MACROS
from generator.vendoring.manifest import read_manifest, sha256_of

INTERFACE = {"carom_collide", "carom_collide_batch", "carom_kernel"}
DISPATCHED = {"carom_target", "carom_target_name", "carom_target_runs", "carom_use_target"}


def run(*command: object, cwd: Path) -> str:
    words = [str(word) for word in command]
    done = subprocess.run(words, cwd=cwd, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, f"{' '.join(words)}\n{done.stderr[-3000:]}"
    return done.stdout


@pytest.mark.parametrize("flags", [(), ("-fvisibility=hidden", "-flto")], ids=["usual", "hidden"])
@pytest.mark.parametrize("targets", ["x86-64-v2", "x86-64-v2,x86-64-v3"])
def test_a_shared_library_exports_the_interface_alone(targets, flags, tmp_path: Path) -> None:
    folder = vendored(tmp_path / "carom", request_for(targets))
    sources = [path.name for path in sorted(folder.glob("*.cpp"))]
    both = ("-std=c++17", "-O1", "-fPIC", "-shared", *flags)
    run("g++", *both, *sources, "-o", "libcarom.so", cwd=folder)
    lines = run("nm", "-D", "--defined-only", "libcarom.so", cwd=folder).splitlines()
    offered = {line.split()[-1] for line in lines}
    print(sorted(offered))
    assert offered == INTERFACE | (DISPATCHED if "," in targets else set())


def test_a_clone_with_other_line_ends_holds_the_same_bytes(tmp_path: Path) -> None:
    origin = vendored(tmp_path / "origin", request_for("x86-64-v2"))
    run("git", "init", "-q", cwd=origin)
    run("git", "add", "-A", cwd=origin)
    who = ("-c", "user.name=carom", "-c", "user.email=carom@localhost")
    run("git", *who, "commit", "-q", "-m", "vendored", cwd=origin)
    run("git", "clone", "-q", "-c", "core.autocrlf=true", "origin", "clone", cwd=tmp_path)
    files = read_manifest(tmp_path / "clone").files
    assert ".gitattributes" in files
    for name, wanted in files.items():
        assert sha256_of((tmp_path / "clone" / name).read_bytes()) == wanted, name


def _macros(folder: Path) -> None:
    lines = "".join(f"#undef {name}\n#define {name} @ {name} @\n" for name in FOREIGN_MACROS)
    (folder / "macros.h").write_text(lines, "utf-8")


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: pair[0])
def test_macros_of_other_headers_do_no_harm(pair, tmp_path: Path) -> None:
    """C and C++ headers, and the implementation in one header, after some 200 of them."""
    folder = vendored(tmp_path / "carom", request_for("x86-64-v2"))
    one = files_for(request_for("x86-64-v3", single_header=True), lanes=True)["carom.h"]
    (folder / "single.h").write_text(one, "utf-8")
    _macros(folder)
    headers = "cstddef optional type_traits utility cmath cstdint cstring limits immintrin.h"
    standard = "".join(f"#include <{name}>\n" for name in headers.split())
    standard += '#include "macros.h"\n'
    texts = {
        "c.c": '#include <stddef.h>\n#include "macros.h"\n#include "carom.h"\n',
        "typed.cpp": f'{standard}#include "carom.hpp"\n',
        "whole.cpp": f'{standard}#define CAROM_IMPLEMENTATION\n#include "single.h"\n',
    }
    for name, text in texts.items():
        (folder / name).write_text(text, "utf-8")
        compiler, language = (pair[1], "c99") if name == "c.c" else (pair[0], "c++17")
        run(compiler, f"-std={language}", "-O1", "-c", name, "-o", "out.o", cwd=folder)
        print(f"{compiler} {name}: compiled after {len(FOREIGN_MACROS)} macros")
