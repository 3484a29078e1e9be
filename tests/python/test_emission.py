"""Emitted text: the same every time, no flag needed, FMA exactly where the axis says."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest
from kernels import ROOT, compile_alone, random_variants, variant

from generator.choice.folder import differences, folders
from generator.choice.selection import read_selection
from generator.emission.kernel_source import emit
from generator.scenes.scene import find_scene
from generator.targets.target import find_target
from generator.toolchain.compilers import find_compilers
from generator.variants.lane_numbers import precision_of
from generator.variants.lanes import widths_of
from generator.variants.names import name_of, source_name_of, variant_of
from generator.variants.presets import find_preset
from generator.verification.reference import MODELS

COMPILERS = [c.path for c in find_compilers()]
GENERATED = sorted((ROOT / "generated").glob("[!n]*/*/*.cpp"))
COMMITTED = [f for f in folders(ROOT / "generated") if f.parent.name != "native"]
TARGETS = sorted({folder.parent.name for folder in COMMITTED})
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
    assert set(wanted) <= set(TARGETS)
    assert {(target, scene) for target in wanted for scene in ("pool", "any")} <= made


@pytest.mark.parametrize("folder", COMMITTED, ids=lambda f: f"{f.parent.name}-{f.name}")
def test_generated_kernels_have_lanes_for_their_batches(folder: Path) -> None:
    """Every model's fixed steps; 1e-6 in scene any, elsewhere with the scene's own model."""
    selection = read_selection(folder)
    assert selection is not None
    target = find_target(selection.resolved)
    exact = MODELS if selection.scene == "any" else (find_scene(selection.scene).model,)
    goals = [(model, {"steps": 1000}) for model in MODELS]
    goals += [(model, {"budget": 1e-6}) for model in exact]
    for model, goal in goals:
        single, batch = selection.find(model, **goal), selection.find_batch(model, **goal)
        assert single is not None and batch is not None, (model, goal)
        print(f"{model}, {goal}: {batch.kernel}")
        numbers = precision_of(variant_of(batch.kernel))
        assert batch.width in widths_of(target, numbers)[1:] and single.width == 1
        assert single.ratio_to_baseline is not None and batch.ratio_to_baseline is not None


def compiled_alone(path: Path, compiler: str, folder: Path, level: str) -> None:
    """As a vendoring user does: no -m flag, warnings are errors."""
    done = compile_alone(path, compiler, folder, level, "-Wpedantic")
    assert done.returncode == 0, done.stderr


class Kind(NamedTuple):
    """Kernels whose texts differ in constants and terms alone."""

    fixed_steps: bool
    lanes: bool


def committed(target: str) -> dict[Kind, list[Path]]:
    """Committed files of a target by kind, in the order of kinds."""
    found: dict[Kind, list[Path]] = {}
    for folder in COMMITTED:
        selection = read_selection(folder)
        assert selection is not None
        for entry in selection.kernels if folder.parent.name == target else ():
            kind = Kind(entry.budget is None, entry.width > 1)
            found.setdefault(kind, []).append(folder / entry.file)
    return dict(sorted(found.items()))


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("compiler", COMPILERS, ids=os.path.basename)
def test_what_is_generated_compiles_alone(compiler: str, target: str, tmp_path: Path) -> None:
    """Compilers take turns over the files of each kind; `-m long` takes all files with all.

    Every file goes through one of them, optimised, though of those in lanes only one a compiler,
    kind and target: the others are read. One of each kind is not optimised.
    """
    place, turn = COMPILERS.index(compiler), TARGETS.index(target)
    for index, (kind, paths) in enumerate(committed(target).items()):
        own = paths[place :: len(COMPILERS)]
        assert own, "fewer files of a kind than compilers"
        first = own[turn % len(own)]  # of scene any and of pool in turn
        for path in own:
            read_only = kind.lanes and path != first
            compiled_alone(path, compiler, tmp_path, "-fsyntax-only" if read_only else "-O2")
        if index == (turn + place) % len(TARGETS):
            compiled_alone(first, compiler, tmp_path, "-O0")


@pytest.mark.long
@pytest.mark.parametrize("level", ["-O0", "-O2"])
@pytest.mark.parametrize("compiler", COMPILERS, ids=os.path.basename)
def test_all_that_is_generated_compiles_alone(compiler: str, level: str, tmp_path: Path) -> None:
    for path in GENERATED:
        compiled_alone(path, compiler, tmp_path, level)


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


@pytest.mark.parametrize("folder", COMMITTED, ids=lambda f: f"{f.parent.name}-{f.name}")
def test_committed_folders_are_fresh(folder: Path) -> None:
    assert differences(folder) == []
