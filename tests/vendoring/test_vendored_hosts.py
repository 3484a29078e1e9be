"""A vendored folder in the builds of others: exports, line ends, macros of other headers."""

from __future__ import annotations

import re
import shutil
from itertools import product
from pathlib import Path

import pytest

from generator.emission.kernel_source import emit
from generator.errors import InputError
from generator.impacts.ball_ball.models import DEFAULT_MODEL, MODELS
from generator.impacts.ball_ball.scene import scenes
from generator.registry.lanes import widths_of
from generator.registry.question import Goal
from generator.targets.target import find_target
from generator.vendoring.manifest import read_manifest, sha256_of
from tests.support.contests import default_kernel
from tests.support.kernels import ROOT
from tests.support.vendored import EXACT, PAIRS, STRICT, files_for, ran, request_for, vendored

INTERFACE = {"carom_collide", "carom_collide_batch", "carom_kernel"}
DISPATCHED = {"carom_target", "carom_target_name", "carom_target_runs", "carom_use_target"}
TWO = "x86-64-v2,x86-64-v3"
LISTED = (ROOT / "tests" / "data" / "foreign_macros.txt").read_text("utf-8")
FOREIGN = re.findall(r"\S+", re.sub(r"^#.*", "", LISTED, flags=re.MULTILINE))
WINDOWS = "x86_64-w64-mingw32-g++"


def exported(library: Path) -> set[str]:
    lines = ran(["nm", "-D", "--defined-only", library]).stdout.splitlines()
    names = {line.split()[-1] for line in lines}
    print(sorted(names))
    return names


def shared_of(sources: list[Path], library: Path, *flags: str, cxx: str = PAIRS[0][0]) -> Path:
    common = ["-std=c++17", *STRICT, "-O0", "-fPIC", "-shared", *flags]
    ran([cxx, *common, *sources, "-o", library])
    return library


def unity(folder: Path, *others: Path) -> Path:
    """One file that includes all sources of folders."""
    sources = [path for each in (folder, *others) for path in sorted(each.glob("*.cpp"))]
    whole = folder.parent / "unity.cc"
    whole.write_text("".join(f'#include "{path}"\n' for path in sources), "utf-8")
    return whole


@pytest.mark.parametrize("flags", [(), ("-fvisibility=hidden", "-flto", "-O1")], ids=["", "hidden"])
@pytest.mark.parametrize("targets", ["x86-64-v2", TWO])
def test_a_shared_library_exports_the_interface_alone(targets, flags, tmp_path: Path) -> None:
    """And a C program that is linked with it runs."""
    folder = vendored(tmp_path / "carom", request_for(targets))
    library = shared_of(sorted(folder.glob("*.cpp")), tmp_path / "libcarom.so", *flags)
    assert exported(library) == INTERFACE | (DISPATCHED if "," in targets else set())
    client, run = ROOT / "tests" / "c" / "one_collision.c", tmp_path / "run"
    search = [f"-I{folder}", f"-L{tmp_path}", f"-Wl,-rpath,{tmp_path}"]
    ran([PAIRS[0][1], "-std=c99", *STRICT, client, *search, "-lcarom", "-lm", "-o", run])
    assert "status 0" in ran([run]).stdout


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: pair[0])
def test_two_prefixes_in_one_unity_build_export_both_interfaces(pair, tmp_path: Path) -> None:
    """With hidden visibility; nothing at all where the copies are said to be somebody's own."""
    goals = {"carom": EXACT, "other": Goal(steps=1000)}
    folders = [
        vendored(tmp_path / prefix, request_for(TWO, goal, prefix=prefix))
        for prefix, goal in goals.items()
    ]
    hidden, whole = "-fvisibility=hidden", unity(*folders)
    both = INTERFACE | DISPATCHED
    both |= {name.replace("carom", "other") for name in both} | {"other_collide_steps"}
    assert exported(shared_of([whole], tmp_path / "a.so", hidden, cxx=pair[0])) == both
    own = ("-DCAROM_API=", "-DOTHER_API=")
    assert exported(shared_of([whole], tmp_path / "b.so", hidden, *own, cxx=pair[0])) == set()


@pytest.mark.skipif(shutil.which(WINDOWS) is None, reason=f"no {WINDOWS}")
def test_a_windows_library_exports_the_interface_alone(tmp_path: Path) -> None:
    folder = vendored(tmp_path / "carom", request_for(TWO))
    library, run = tmp_path / "carom.dll", tmp_path / "run.exe"
    sources = sorted(folder.glob("*.cpp"))
    shared_of(sources, library, "-Dcarom_EXPORTS", cxx=WINDOWS)
    told = ran(["x86_64-w64-mingw32-objdump", "-p", library]).stdout
    table = told.split("[Ordinal/Name Pointer] Table")[1].split("\n\n")[0]
    names = {line.split()[-1] for line in table.splitlines()[1:]}
    print(sorted(names))
    assert names == INTERFACE | DISPATCHED
    client = ["-x", "c++", ROOT / "tests" / "c" / "one_collision.c", "-x", "none"]
    ran([WINDOWS, "-DCAROM_SHARED", f"-I{folder}", *client, library, "-o", run])


def test_one_header_serves_several_files(tmp_path: Path) -> None:
    """Implemented in one, used by another in C++ and one in C; with hidden visibility."""
    folder = vendored(tmp_path / "carom", request_for("x86-64-v2", single_header=True))
    texts = {
        "whole.cpp": '#define CAROM_IMPLEMENTATION\n#include "carom.h"\n#include "carom.h"\n',
        "user.cpp": '#include "carom.h"\nconst char* told() { return carom_kernel(); }\n',
    }
    objects = []
    for name, text in texts.items():
        (tmp_path / name).write_text(text, "utf-8")
        objects.append(tmp_path / f"{name}.o")
        command = [PAIRS[0][0], "-std=c++17", *STRICT, "-O0", "-fvisibility=hidden", f"-I{folder}"]
        ran([*command, "-c", tmp_path / name, "-o", objects[-1]])
    client, run = ROOT / "tests" / "c" / "one_collision.c", tmp_path / "run"
    ran([PAIRS[0][1], "-std=c99", *STRICT, f"-I{folder}", client, *objects, "-lm", "-o", run])
    assert "status 0" in ran([run]).stdout


def test_a_clone_with_other_line_ends_holds_the_same_bytes(tmp_path: Path) -> None:
    origin = vendored(tmp_path / "origin", request_for("x86-64-v2"))
    git = ["git", "-c", "user.name=carom", "-c", "user.email=carom@localhost"]
    ran([*git, "init", "-q"], cwd=origin)
    ran([*git, "add", "-A"], cwd=origin)
    ran([*git, "commit", "-q", "-m", "vendored"], cwd=origin)
    others = ["-c", "core.autocrlf=true", "-c", "core.eol=crlf"]
    ran([*git, "clone", "-q", *others, origin, tmp_path / "clone"])
    files = read_manifest(tmp_path / "clone").files
    assert ".gitattributes" in files
    for name, wanted in files.items():
        assert sha256_of((tmp_path / "clone" / name).read_bytes()) == wanted, name
    print(f"{len(files)} files as they were")


def identifiers(text: str) -> set[str]:
    """Of C++ text; not those in comments, strings and names of headers."""
    for pattern in (r"/\*.*?\*/|//[^\n]*", r'"(?:\\.|[^"\\\n])*"', r"#\s*include[^\n]*"):
        text = re.sub(pattern, " ", text, flags=re.DOTALL)
    return set(re.findall(r"(?<![\w.'])[A-Za-z_]\w*", text))


def emitted_kinds() -> dict[str, str]:
    """Kernels for calls and in lanes: every instruction set, model and scene."""
    known = ("x86-64-v2", "x86-64-v3", "zen4", "armv8")
    kinds = {(name, "any", DEFAULT_MODEL) for name in known}
    kinds |= {("x86-64-v3", "any", model.name) for model in MODELS}
    kinds |= {("x86-64-v3", scene, DEFAULT_MODEL) for scene in scenes()}
    goals = (EXACT, Goal(steps=1000))
    texts = {}
    for (name, scene, model), goal in product(sorted(kinds), goals):
        target = find_target(name)
        for width in sorted({1, max(widths_of(target))}):
            try:
                variant = default_kernel(target, scene, model, goal).in_lanes(width)
                texts[f"{name} {scene} {model} {goal} {width}"] = emit(variant).source
            except (InputError, ValueError):
                continue  # there is none
    return texts


def test_no_identifier_is_a_macro_of_another_header() -> None:
    """Names that Xlib, windows.h, Arduino, curses, math.h and sys/*.h have as macros."""
    texts = emitted_kinds()
    for name, text in files_for(request_for(f"{TWO},armv8"), lanes=True).items():
        if name.endswith((".h", ".hpp", ".cpp")):
            texts[name] = text
    guarded = "#ifndef Status\nusing Status = CollisionStatus;\n#endif\n"
    assert guarded in texts["carom.hpp"]
    texts["carom.hpp"] = texts["carom.hpp"].replace(guarded, "")
    found = {place: identifiers(text) & set(FOREIGN) for place, text in texts.items()}
    print(f"{len(texts)} files, {len(FOREIGN)} macros")
    assert len(texts) > 40 and len(FOREIGN) > 1500
    assert {place: sorted(names) for place, names in found.items() if names} == {}


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: pair[0])
def test_macros_of_other_headers_do_no_harm(pair, tmp_path: Path) -> None:
    """C and C++ headers, and the implementation in one header, after all of them.

    What C++'s own library includes comes first: no header of that would survive them.
    """
    folder = vendored(tmp_path / "carom", request_for("x86-64-v2"))
    one = files_for(request_for(TWO, prefix="mine", single_header=True), lanes=True)["mine.h"]
    (folder / "mine.h").write_text(one, "utf-8")
    lines = "".join(f"#undef {name}\n#define {name} @ {name} @\n" for name in FOREIGN)
    (folder / "macros.h").write_text(lines, "utf-8")
    both = (folder / "carom.hpp").read_text("utf-8") + one
    found = re.findall(r"#include <(.*)>", both)
    first = "".join(f"#include <{name}>\n" for name in sorted(set(found))) + '#include "macros.h"\n'
    texts = {
        "c.c": '#include <stddef.h>\n#include "macros.h"\n#include "carom.h"\n',
        "typed.cpp": f'{first}#include "carom.hpp"\n',
        "whole.cpp": f'{first}#define MINE_IMPLEMENTATION\n#include "mine.h"\n',
    }
    for name, text in texts.items():
        (folder / name).write_text(text, "utf-8")
        compiler, language = (pair[1], "c99") if name == "c.c" else (pair[0], "c++17")
        ran([compiler, f"-std={language}", "-O0", "-c", folder / name, "-o", tmp_path / "out.o"])
        print(f"{compiler} {name}: compiled after {len(FOREIGN)} macros")
