"""Operations: those counted by running a kernel are those that its file states."""

from __future__ import annotations

import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from generator.choice.folder import folders
from generator.choice.selection import read_selection
from generator.emission.kernel_source import emit
from generator.evidence.profiling.counting import KINDS, count_operations, instrumented
from generator.impacts.ball_ball.evidence.scene_cases import cases_for_scene
from generator.impacts.ball_ball.presets import PRESETS, find_preset
from generator.impacts.ball_ball.scene import find_scene
from generator.lowering.counts import OperationCounts
from generator.registry.names import name_of
from generator.registry.question import DEFAULT_IMPACT
from generator.registry.variant import Stepper, Variant, fixed_steps, make_variant
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.compilers import find_compilers
from tests.support.reference import load_reference

EULER = fixed_steps(1000)
ROOT = Path(__file__).parents[2]
COUNTED = tuple(kind for kind in KINDS if kind not in ("call", "rare"))
_STATED = re.compile(r"Operations (?:an iteration|a step): (.*?) \(\d+ flops\)", re.S)


def _target() -> str:
    return "x86-64-v3" if read_host().runs(find_target("x86-64-v3")) else "x86-64-v2"


def _stated(source: str) -> dict[str, int]:
    """The counts in a kernel's comment, which clang-format may have broken over lines."""
    text = " ".join(_STATED.search(source)[1].replace("//", " ").split())
    found = {kind: int(number) for number, kind in (part.split() for part in text.split(", "))}
    return {kind: found.get(kind, 0) for kind in COUNTED}


def _counted(variant: Variant, cache: Path, source: str | None = None) -> tuple[str, dict, dict]:
    emitted = emit(variant)
    compiler = find_compilers()[0]
    cases = cases_for_scene(find_scene(variant.scene), load_reference().cases[::95], variant.model)
    flags = ("-std=c++17", "-O1", f"-march={find_target(variant.target).row.march}")
    apart = variant.stepper.family == "exact"
    counted = count_operations(emitted, compiler, flags, cases, cache, apart=apart)
    assert counted.per_iteration is not None
    taken = counted.per_iteration.as_dict()
    return (
        name_of(variant),
        {kind: taken[kind] for kind in COUNTED},
        _stated(source if source is not None else emitted.source),
    )


def _compare(variants: list[Variant], cache: Path, sources: list[str | None]) -> None:
    with ThreadPoolExecutor(2) as pool:
        rows = list(pool.map(lambda v, s: _counted(v, cache, s), variants, sources))
    for name, counted, stated in rows:
        print(f"counted {OperationCounts(**counted).describe()} = stated: {name}")
        assert counted == stated, name
    assert rows


def _euler(**options: str) -> Variant:
    if not find_target(_target()).has("fma"):
        options["fma"] = "nofma"
    return make_variant(_target(), "any", "mathavan2014", EULER, **options)


def test_presets_take_the_operations_that_their_files_state(tmp_path: Path) -> None:
    variants = [_euler(**preset.options) for preset in PRESETS]
    lanes = {"state": "reduced", "reuse": "precompute", "branch": "chosen", "roots": "early"}
    variants.append(_euler(**lanes, rsqrt="est1", simd="slips", fma="fma"))
    balls = {**find_preset("paper-simd-rewritten").options, "fma": "nofma"}  # as without AVX
    variants.append(make_variant("x86-64-v2", "any", "mathavan2014", EULER, **balls))
    _compare(variants, tmp_path, [None] * len(variants))


@pytest.mark.parametrize("scene", ["any", "free", "unequal"])
def test_exact_steps_take_the_operations_that_their_files_state(scene: str, tmp_path: Path) -> None:
    fused = "fma" if find_target(_target()).has("fma") else "nofma"
    rows = (("dp54", 1e-2, "est0", fused), ("dp54", 1e-6, "inv", "nofma"))
    rows += (("dop853", 1e-9, "cubic", fused),)
    variants = [
        make_variant(
            _target(), scene, "mathavan2014", Stepper(name, budget=budget), root=root, fma=fma
        )
        for name, budget, root, fma in rows
    ]
    _compare(variants, tmp_path, [None] * len(variants))


def test_committed_kernels_take_the_operations_that_their_files_state(tmp_path: Path) -> None:
    variants, sources = [], []
    for folder in folders(ROOT / "generated"):
        if folder.parent.name != _target():
            continue
        selection = read_selection(folder)
        assert selection is not None
        if selection.impact != DEFAULT_IMPACT:
            continue  # the cushion's loops have no regions yet
        for entry in selection.kernels:
            if entry.width == 1 and entry.goal.steps and selection.scene == "any":
                variants.append(entry.variant)
                sources.append((folder / entry.file).read_text("utf-8"))
    _compare(variants, tmp_path, sources)


def test_a_closed_form_has_no_regions_and_is_counted_whole() -> None:
    assert instrumented("int main() {}\n") == "int main() {}\n"
