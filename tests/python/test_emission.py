"""Emitted text: the same every time, no flag needed, FMA exactly where the axis says."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from kernels import ROOT, compile_alone, random_variants, variant

from generator.choice.folder import differences, folders
from generator.emission.kernel_source import emit
from generator.toolchain.compilers import find_compilers
from generator.variants.names import name_of, source_name_of
from generator.variants.presets import find_preset

COMPILERS = [c.path for c in find_compilers()]
GENERATED = sorted((ROOT / "generated").glob("[!n]*/*/*.cpp"))
FMA = re.compile(r"\bvfn?m(add|sub)")
C_MAIN = Path(__file__).parents[1] / "c" / "one_collision.c"
EMIT_ALL = """
import sys
from generator.emission.kernel_source import emit
from generator.variants.names import variant_of
for name in sys.stdin.read().split():
    source = emit(variant_of(name))
    sys.stdout.write(source.header + source.source + source.probe)
"""


def disassembled(folder: Path) -> str:
    done = subprocess.run(
        ["objdump", "-d", "--no-show-raw-insn", str(folder / "kernel.o")],
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


@pytest.mark.skipif(shutil.which("objdump") is None, reason="no objdump")
@pytest.mark.parametrize("compiler", COMPILERS, ids=os.path.basename)
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"reuse": "precompute", "rsqrt": "est1", "branch": "inverted", "roots": "early"},
        {"simd": "prepost"},
        find_preset("reduced-ahead").options,
        find_preset("paper-simd-rewritten").options,
        {**find_preset("reduced").options, "simd": "slips", "rsqrt": "est2"},
    ],
    ids=["default", "inverted", "prepost", "ahead", "balls", "slips"],
)
def test_fma_is_where_the_axis_says(compiler: str, options: dict[str, str], tmp_path: Path) -> None:
    """Without a flag but -O3: the text decides, not the compiler's default for contraction."""
    found = {}
    for fma in ("nofma", "fma"):
        each = variant(**{**options, "fma": fma})
        done = compile_alone(emit(each), compiler, tmp_path / fma, "-O3")
        assert done.returncode == 0, done.stderr
        found[fma] = len(FMA.findall(disassembled(tmp_path / fma)))
    print(f"{Path(compiler).name}: {found} fused instructions")
    assert found["nofma"] == 0
    assert found["fma"] >= 6


def test_generated_folder_is_complete() -> None:
    made = {path.relative_to(ROOT / "generated").parts[:2] for path in GENERATED}
    wanted = ("zen3", "x86-64-v2", "x86-64-v3", "x86-64-v4")
    assert {(target, scene) for target in wanted for scene in ("pool", "any")} <= made


@pytest.mark.parametrize("compiler", COMPILERS, ids=os.path.basename)
def test_what_is_generated_compiles_alone(compiler: str, tmp_path: Path) -> None:
    """As a vendoring user does: no -m flag, warnings are errors, not optimised and optimised."""
    for path in GENERATED:
        for level in ("-O0", "-O2"):
            done = compile_alone(path, compiler, tmp_path, level, "-Wpedantic")
            assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("compiler", COMPILERS, ids=os.path.basename)
def test_c99_program_collides(compiler: str, tmp_path: Path) -> None:
    """carom.h serves C99; the kernel is linked in and runs."""
    cc = {"g++": "gcc", "clang++": "clang"}
    name = Path(compiler).name
    stem = name.split("-")[0]
    c_compiler = shutil.which(name.replace(stem, cc[stem])) or shutil.which(cc[stem]) or "cc"
    path = next(p for p in GENERATED if p.parts[-3:-1] == ("x86-64-v2", "any"))
    done = compile_alone(path, compiler, tmp_path, "-O2")
    assert done.returncode == 0, done.stderr
    strict = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-I{path.parent}"]
    subprocess.run(
        [c_compiler, *strict, "-c", str(C_MAIN), "-o", str(tmp_path / "main.o")], check=True
    )
    objects = [str(tmp_path / "main.o"), str(tmp_path / "kernel.o")]
    subprocess.run([compiler, *objects, "-o", str(tmp_path / "run")], check=True)
    told = subprocess.run([str(tmp_path / "run")], capture_output=True, text=True, check=True)
    print(told.stdout)
    assert path.stem in told.stdout


def test_same_bytes_in_another_process() -> None:
    made = [variant(**find_preset("reduced-ahead").options), variant()]
    made += random_variants(21, 4, ("zen3", "x86-64-v4"))
    names = "\n".join(name_of(v) for v in made)
    texts = []
    for seed in ("1", "77"):
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            [sys.executable, "-P", "-c", EMIT_ALL],
            input=names,
            capture_output=True,
            text=True,
            env=environment,
            check=True,
        )
        texts.append(done.stdout)
    assert texts[0] == texts[1]
    assert len(texts[0]) > 1000 * len(made)


def test_banner_names_its_makers_and_nothing_of_this_machine() -> None:
    each = variant(**find_preset("reduced-ahead").options)
    source = emit(each)
    for text, template in ((source.source, "kernel.cpp.j2"), (source.header, "carom.h.j2")):
        head = text.split("#", 1)[0]
        for wanted in ("Do not edit", "MIT-0", f"templates/{template}", "./gen --target", "sha256"):
            assert wanted in head
        assert not re.search(r"20[2-9]\d-|/home|/root|/work|/tmp", head)
        assert os.uname().nodename not in head
    assert source_name_of(each) in source.source


def test_operation_counts_are_in_the_text() -> None:
    source = emit(variant(**find_preset("reduced-ahead").options))
    assert source.counts.describe() in source.source
    assert source.counts.flops > 40


def test_committed_folders_are_fresh() -> None:
    for folder in folders(ROOT / "generated"):
        if folder.parent.name != "native":
            assert differences(folder) == []
