"""The cause is in the line: of CMake, compilers, linkers, pip, and of a CSV that is none."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest

from generator.api import read_cases
from generator.errors import InputError, KernelError
from generator.evidence.timing.bench_tool import build_bench_tool
from generator.toolchain.process import Finished, require_space, run, run_checked
from generator.toolchain.reasons import reason_in
from tests.support.reference import FOLDER

LINES = (FOLDER / "inputs.csv").read_text("utf-8").splitlines()[:4]


def failed(tmp_path: Path, *command: str) -> str:
    """The line of a program that fails; its log holds all that it printed."""
    log = tmp_path / "failed.log"
    with pytest.raises(KernelError) as caught:
        run_checked(command, 60.0, "making", log)
    text = str(caught.value)
    print(text)
    assert "\n" not in text and text.endswith(f"(log: {log})")
    assert log.read_text().startswith(f"$ {command[0]}")
    return text


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("find_package(Nowhere REQUIRED)", 'By not providing "FindNowhere.cmake"'),
        (
            'message(FATAL_ERROR "needs Nail and\nHammer")',
            "Nail and",
        ),
        ("no_such_command()", "no_such_command"),
    ],
)
def test_an_error_of_cmake_is_told_with_its_message(text, part, tmp_path) -> None:
    (tmp_path / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.16)\nproject(a NONE)\n{text}\n"
    )
    told = failed(tmp_path, "cmake", "-S", str(tmp_path), "-B", str(tmp_path / "b"))
    assert "CMakeLists.txt:3: " in told or 'Unknown CMake command "no_such_command"' in told
    assert part in told


def test_a_compiler_that_cannot_link_is_told_with_what_the_linker_says(tmp_path) -> None:
    (tmp_path / "g++").write_text(
        f'#!/bin/sh\nexec {shutil.which("g++")} -lnowhere "$@" -lnowhere\n'
    )
    (tmp_path / "g++").chmod(0o755)
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\nproject(a CXX)\n"
    )
    options = (
        "-S",
        str(tmp_path),
        "-B",
        str(tmp_path / "b"),
        f"-DCMAKE_CXX_COMPILER={tmp_path}/g++",
    )
    told = failed(tmp_path, "cmake", *options)
    assert "is not able to compile a simple test program." in told and "-lnowhere" in told


@pytest.mark.parametrize(
    ("code", "part"),
    [
        ("#include <nowhere.h>", "nowhere.h: No such file"),
        ("int f(); int main() { return f(); }", "undefined reference to `f()'"),
        ('int main() { asm("nonsense"); }', "no such instruction: `nonsense'"),
    ],
)
def test_an_error_of_the_compiler_or_linker_is_told_before_the_summary(
    code, part, tmp_path
) -> None:
    (tmp_path / "a.cpp").write_text(code)
    (tmp_path / "build.ninja").write_text(
        "rule cc\n command = g++ -Werror -DERROR=error $in -o $out\nbuild a: cc a.cpp\n"
    )
    assert part in failed(tmp_path, "g++", str(tmp_path / "a.cpp"), "-o", str(tmp_path / "a"))
    assert part in failed(tmp_path, "ninja", "-C", str(tmp_path))


def test_an_exception_is_told_not_where_it_was_raised(tmp_path) -> None:
    told = failed(tmp_path, sys.executable, "-c", "raise ValueError('error: the cause')")
    assert "ValueError: error: the cause" in told


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", ""),
        ("Killed\n", "Killed"),
        ("FAILED: error.o\nc++ -Werror -c error.cpp\na.cpp:1: error: x\n", "a.cpp:1: error: x"),
        (
            "error: subprocess-exited-with-error\n  build did not run\n  ld: cannot find -lz\n",
            "ld: cannot find -lz",
        ),
        (
            "g++: fatal error: Killed signal\ncompilation terminated.",
            "g++: fatal error: Killed signal",
        ),
        ("collect2: error: ld returned 1", "collect2: error: ld returned 1"),
        ("a.cpp:1: error: " + "x" * 400, "a.cpp:1: error: " + "x" * 280 + " ..."),
    ],
)
def test_reasons(text, reason) -> None:
    assert reason_in(text) == reason


def test_a_full_disk_is_no_fault_of_the_kernel(tmp_path) -> None:
    done = Finished(1, "", "as: /tmp/a.s: Fatal error: /c/a.o: No space left on device\n")
    with pytest.raises(InputError, match=r"No space left on device; free some.*CAROM_CACHE"):
        require_space(done, tmp_path)
    full = run(["g++", "-x", "c++", "-c", "/dev/null", "-o", "/dev/full"], 60.0)
    with pytest.raises(InputError, match=r"/dev/full.*No space left"):
        require_space(full, tmp_path)


def test_a_bench_that_cannot_be_configured_names_its_log(tmp_path) -> None:
    root = tmp_path / "root"
    (root / "bench").mkdir(parents=True)
    (root / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\nproject(a NONE)\nfind_package(CLI11 9 REQUIRED)\n"
    )
    with pytest.raises(KernelError) as caught:
        build_bench_tool(tmp_path / "cache", root)
    print(caught.value)
    log = str(caught.value).split("(log: ")[1].rstrip(")")
    assert "configuring carom_bench: CMakeLists.txt:3: " in str(caught.value)
    assert "CLI11" in Path(log).read_text()


# ---- CSV -------------------------------------------------------------------------------------


def read(folder: Path, text: str | bytes) -> list[str]:
    path = folder / "cases.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    table = read_cases(path)
    want = read_cases(FOLDER / "inputs.csv").rows[: len(table.ids)]
    assert (table.rows == want).all()
    return list(table.ids)


@pytest.mark.parametrize(
    ("how", "change"),
    [
        ("blanks after commas", lambda t: t.replace(",", ", ")),
        ("blanks on both sides", lambda t: t.replace(",", " , ")),
        ("a byte order mark", lambda t: "\ufeff" + t),
        ("lines of Windows", lambda t: t.replace("\n", "\r\n")),
        ("quotes", lambda t: '"' + t.strip().replace(",", '", "').replace("\n", '"\n"') + '"\n'),
        ("blank lines at the end", lambda t: t + "\n \n\n"),
        ("rows of commas at the end, as of Excel", lambda t: t + "," * 24 + "\n"),
        ("no end of the last line", str.strip),
    ],
)
def test_cases_are_read_with(how, change, tmp_path) -> None:
    assert len(read(tmp_path, change("\n".join(LINES) + "\n"))) == 3, how


def test_ids_are_kept_as_they_are_also_twice(tmp_path) -> None:
    rows = [LINES[0], *(f"same,{line.split(',', 1)[1]}" for line in LINES[1:])]
    assert read(tmp_path, "\n".join(rows)) == ["same"] * 3


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        (lambda t: t.replace(",", ";"), ("row 1", "separated by semicolons", "expected commas")),
        (lambda t: t.replace(",", ";").replace(".", ","), ("separated by semicolons", "point")),
        (lambda t: t.replace(",", "\t"), ("separated by tabs",)),
        (lambda t: t.replace(",", "|"), ("separated by bars",)),
        (lambda t: t.replace(",", " "), ("separated by blanks",)),
        (lambda t: t.replace(".", ",", 3), ("row 2", "more values", "a point in numbers")),
        (lambda t: "", ("row 1: is empty", "expected id,R")),
        (lambda t: "\n\n", ("row 1: is empty",)),
        (lambda t: t.replace("w2z", "spin", 1), ("row 1", "no column w2z")),
        (lambda t: t.split("\n", 1)[1], ("row 1", "no column id")),
        (lambda t: t.encode("utf-16"), ("not a text file in UTF-8",)),
        (lambda t: t[:200] + "\0" + t[200:], ("row", "")),
    ],
)
def test_cases_that_cannot_be_read_say_why(change, parts, tmp_path) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, change("\n".join(LINES) + "\n"))
    print(caught.value)
    assert all(part in str(caught.value) for part in (*parts, "cases.csv"))
