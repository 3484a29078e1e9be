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
from jinja2 import meta

from generator import __version__
from generator.choice.candidates import candidates_of
from generator.choice.folder import differences, folders
from generator.choice.selection import read_selection
from generator.emission.banner import _generator, inputs_hash
from generator.emission.context import Field
from generator.emission.environment import environment, templates_folder
from generator.emission.kernel_source import emit
from generator.errors import InputError
from generator.evidence.verification.evidence import evidence_of
from generator.impacts.ball_ball.presets import find_preset
from generator.impacts.ball_ball.scene import find_scene, scenes
from generator.registry.lane_numbers import precision_of
from generator.registry.lanes import widths_of
from generator.registry.names import name_of, variant_named
from generator.registry.question import Goal, find_impact
from generator.registry.rules import require_legal
from generator.targets.target import find_target
from generator.toolchain.compilers import find_compilers
from tests.support.contests import default_kernel
from tests.support.kernels import ROOT, compile_alone, random_variants, variant

COMPILERS = [c.path for c in find_compilers()]
GENERATED = sorted((ROOT / "generated").glob("*/[!n]*/*/*.cpp"))
COMMITTED = [f for f in folders(ROOT / "generated") if f.parent.name != "native"]
TARGETS = sorted({folder.parent.name for folder in COMMITTED})
OTHER_SCENES = [name for name in scenes() if name != "any"]
FMA = re.compile(r"\bvfn?m(add|sub)")
C_MAIN = Path(__file__).parents[1] / "c" / "one_collision.c"


def named(folder: Path) -> str:
    """A folder of generated/ in the name of a test."""
    return "-".join(folder.relative_to(ROOT / "generated").parts)


EMIT_ALL = """
import sys
from generator.emission.banner import _generator, inputs_hash
from generator.emission.environment import environment, templates_folder
from generator.emission.kernel_source import emit
from generator.registry.names import variant_of
for name in sys.stdin.read().splitlines():
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


def test_a_budget_is_promised_for_a_documented_range() -> None:
    """The model's, as far as the scene goes; that a search looks at."""
    text = emit(
        variant_named("ball-ball/zen3/pool/pooltool-e1m06-x1 dp54 root=cubic fma=fma")
    ).source
    told = " ".join(line.removeprefix("// ") for line in text.splitlines() if line.startswith("//"))
    print(told[told.index("Stepper:") :][:250])
    assert "by design, u_b to 0.3 and u_s to 0.2; the largest error found by search" in told


def test_generated_folder_is_complete() -> None:
    made = {path.relative_to(ROOT / "generated").parts[1:3] for path in GENERATED}
    wanted = ("zen3", "x86-64-v2", "x86-64-v3", "x86-64-v4")
    assert set(wanted) <= set(TARGETS)
    assert {(target, "any") for target in wanted} <= made
    assert {scene for _, scene in made} == {"any"}, "other scenes are emitted where they are tested"


@pytest.mark.parametrize("folder", COMMITTED, ids=named)
def test_generated_kernels_have_lanes_for_their_batches(folder: Path) -> None:
    """Fixed steps and 1e-6 of every model, where its impact has such kernels."""
    selection = read_selection(folder)
    assert selection is not None
    target, impact = find_target(selection.resolved), find_impact(selection.impact)
    steps_alone = evidence_of(impact).exact_models
    models = [model.name for model in impact.model_table()]
    goals = [(model, Goal(steps=1000)) for model in models]
    goals += [(model, Goal(budget=1e-6)) for model in models if model not in steps_alone]
    for model, goal in goals:
        single, batch = selection.find(model, goal), selection.find(model, goal, batch=True)
        assert single is not None and single.width == 1, (model, goal)
        assert single.evidence, "what the choice rests on"
        if goal.budget is None and not candidates_of(impact).fixed_lanes:
            continue
        if goal.budget is not None and impact.find_scene(selection.scene).without_exact_lanes:
            continue
        assert batch is not None and batch.evidence, (model, goal)
        print(f"{model}, {goal}: {batch.kernel}")
        numbers = precision_of(batch.variant)
        assert batch.width in widths_of(target, numbers)[1:]


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
            kind = Kind(entry.goal.budget is None, entry.width > 1)
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
        first = own[turn % len(own)]
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


@pytest.mark.parametrize("scene", OTHER_SCENES)
def test_kernels_of_other_scenes_compile_alone(scene: str, tmp_path: Path) -> None:
    """What is chosen for scene any, where the scene takes it; compilers take turns."""
    turn, made = OTHER_SCENES.index(scene), 0
    target = find_target(TARGETS[turn % len(TARGETS)])
    selection = read_selection(ROOT / "generated" / "ball-ball" / target.name / "any")
    assert selection is not None
    model = find_scene(scene).model
    goal = Goal(budget=find_scene(scene).max_error)
    variants = [entry.variant for entry in selection.kernels if entry.model == model]
    for each in (default_kernel(target, scene, model, goal), *variants):
        each = each.moved(scene=scene)
        try:
            require_legal(each, target)
            source = emit(each)
        except (InputError, ValueError) as error:
            print(f"{each.stepper.name}: {error}")
            continue
        compiler = COMPILERS[(turn + made) % len(COMPILERS)]
        done = compile_alone(source, compiler, tmp_path / str(made), "-O1", "-Wpedantic")
        assert done.returncode == 0, done.stderr
        made += 1
    print(f"scene {scene}: {made} of {target.name}'s kernels")
    assert made > 0


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


EXACT = "ball-ball/zen3/any/mathavan2014-e1m06-x1 dp54 root=est1 fma=fma"
FIXED = (
    "ball-ball/zen3/any/pooltool-n1000-x1 fixed state=reduced reuse=factored order=chain "
    "rsqrt=ahead roots=early fma=fma branch=chosen"
)


def remake_of(text: str) -> list[str]:
    """The arguments of the command that a banner names."""
    words = re.search(r"^(?://| \*) remake: +\./gen (.*)$", text, re.MULTILINE)
    assert words is not None
    return words[1].split()


def inputs_of(text: str) -> str:
    found = re.search(r"inputs: +sha256 ([0-9a-f]{16})$", text, re.MULTILINE)
    assert found is not None
    return found[1]


@pytest.mark.parametrize("name", [EXACT, FIXED])
def test_banner_names_its_makers_and_nothing_of_this_machine(name: str) -> None:
    source = emit(variant_named(name))
    question, recipe = name.split(" ", 1)
    rows = (f"// question: {question}\n", f"// recipe:   {recipe}\n", "// counts:   ")
    for text, own in ((source.source, rows), (source.header, (" * scene:    any\n",))):
        head = text.split("#", 1)[0]
        for wanted in (
            f"by carom {__version__}. Do not edit",
            "MIT-0",
            "./gen emit",
            "sha256",
            *own,
        ):
            assert wanted in head
        assert not re.search(r"20[2-9]\d-|/home|/root|/work|/tmp", head)
        assert os.uname().nodename not in head
    assert name in "".join(re.findall(r'"([^"]*)"', source.source.split("carom_kernel(void)")[1]))


def test_the_command_of_a_banner_makes_the_file_again(tmp_path: Path) -> None:
    """As a shell runs it: the bytes that the main job writes, on standard output or in a file."""
    selection, out = (
        read_selection(ROOT / "generated" / "ball-ball" / "zen3" / "any"),
        tmp_path / "again",
    )
    assert selection is not None
    entry = next(entry for entry in selection.kernels if entry.goal.budget)
    source = emit(entry.variant, grounds=entry.grounds)
    for text, more in ((source.source, []), (source.header, ["--out", str(out)])):
        done = subprocess.run(
            [sys.executable, "-P", "-m", "generator", *remake_of(text), *more],
            capture_output=True,
            check=True,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )
        assert (out.read_bytes() if more else done.stdout) == text.encode()


# What a change of a template changes the inputs of.
USED_BY = {
    "ball_ball/exact/plan.j2": {"exact"},
    "ball_ball/exact/macros.j2": {"exact"},  # imported
    "lanes/scalar.j2": {"exact"},
    "ball_ball/fixed_step/helpers/refined.j2": {"fixed"},  # its name is decided in Python
    "ball_ball/sections/leave.j2": {"exact", "fixed"},
    "carom.h.j2": {"header"},
    "vendor/README.md.j2": set(),
}


def test_inputs_change_with_the_templates_of_a_text_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "templates"
    shutil.copytree(templates_folder(), folder)
    monkeypatch.setattr("generator.emission.environment.templates_folder", lambda: folder)
    monkeypatch.setattr("generator.emission.banner.templates_folder", lambda: folder)
    monkeypatch.setattr("generator.emission.kernel_source.format_source", lambda text, _: text)

    def inputs() -> dict[str, str]:
        exact, fixed = (emit(variant_named(name)) for name in (EXACT, FIXED))
        texts = {"exact": exact.source, "fixed": fixed.source, "header": exact.header}
        return {kind: inputs_of(text) for kind, text in texts.items()}

    environment.cache_clear()
    try:
        before = inputs()
        for template, expected in USED_BY.items():
            changed = folder / template
            changed.write_text(changed.read_text("utf-8") + "{# another comment #}", "utf-8")
            after = inputs()
            differ = {kind for kind in before if before[kind] != after[kind]}
            print(f"{template}: changes the inputs of {sorted(differ)}")
            assert differ == expected
            before = after
    finally:
        environment.cache_clear()


def test_inputs_change_with_a_pinned_tool_and_with_data(monkeypatch: pytest.MonkeyPatch) -> None:
    found = {inputs_hash(["carom.h.j2"], data) for data in ([], ["a"], ["b"])}
    _generator.cache_clear()
    monkeypatch.setattr("importlib.metadata.version", lambda name: f"another {name}")
    found.add(inputs_hash(["carom.h.j2"], []))
    _generator.cache_clear()
    assert len(found) == 4


def test_what_templates_import_imports_nothing_itself() -> None:
    """Jinja makes a module of it once a process: what it loads then is noted for one text alone."""
    texts = {p: p.read_text("utf-8") for p in templates_folder().rglob("*.j2")}
    imported = {m for text in texts.values() for m in re.findall(r'(?:from|import) "(.+?)"', text)}
    print(f"imported: {sorted(imported)}")
    assert imported
    for name in imported:
        path = templates_folder() / name
        if path.exists():
            assert not re.search(r"{%-? *(?:include|import|from|extends)", texts[path]), name


ACCEPTS = re.compile(r"{% accepts (nothing|(?P<names>.+?)(?: if .+)?) %}$")


def _declared(line: str) -> dict[str, tuple[str, ...]]:
    """The types of each name that a first line accepts."""
    found = ACCEPTS.match(line)
    assert found, f"the first line says what is accepted: {{% accepts ... %}}, not {line}"
    pairs = [pair.split(": ") for pair in (found["names"] or "").split(", ") if pair]
    return {name: tuple(kinds.split(" | ")) for name, kinds in pairs}


def _exists(kind: str) -> bool:
    module, _, name = kind.rpartition(".")
    source = ROOT / "generator" / f"{module.replace('.', '/')}.py"
    return not module or bool(re.search(rf"^class {name}\b", source.read_text(), re.MULTILINE))


def test_every_template_accepts_on_its_first_line_just_what_it_reads() -> None:
    for path in sorted(templates_folder().rglob("*.j2")):
        name = path.relative_to(templates_folder()).as_posix()
        first, rest = path.read_text("utf-8").split("\n", 1)
        declared = _declared(first)
        made_here = set(re.findall(r"{%-? set (\w+) =", rest))
        reads = meta.find_undeclared_variables(environment().parse(rest)) - made_here
        assert set(declared) == reads, name
        assert all(_exists(kind) for kinds in declared.values() for kind in kinds), name


def test_a_template_refuses_what_it_does_not_accept() -> None:
    text = "{% accepts k: emission.context.Field | None, n: int if n in (4, 8) %}\nx\n"
    template = environment().from_string(text)
    assert template.render(k=None, n=8) == template.render(k=Field("R", "radius"), n=4) == "x\n"
    for wrong in ({"k": 1, "n": 4}, {"k": None, "n": 4.0}, {"k": None, "n": 5}, {"n": 4}):
        with pytest.raises(TypeError, match=r"accepted|condition"):
            template.render(**wrong)


def test_operation_counts_are_in_the_text() -> None:
    source = emit(variant(**find_preset("reduced-ahead").options))
    assert source.counts.describe() in source.source
    assert source.counts.flops > 40


@pytest.mark.parametrize("folder", COMMITTED, ids=named)
def test_committed_folders_are_fresh(folder: Path) -> None:
    assert differences(folder) == []
