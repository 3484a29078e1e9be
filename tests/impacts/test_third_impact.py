"""A made-up third impact: new files and one row, from text to verified kernels."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from generator.choice.candidates import baseline, default_kernel
from generator.choice.kernel import Verified
from generator.choice.workbench import Workbench
from generator.emission import banner, environment
from generator.emission.header import header_of
from generator.evidence.timing.bench_tool import Way, build_bench_tool
from generator.impacts import registry
from generator.impacts.ball_ball.row import BALL_BALL
from generator.places import cache_folder
from generator.registry.question import Contest, Goal, read_question
from generator.targets.target import find_target
from generator.toolchain.compilers import find_compilers
from tests.impacts.wall.row import WALL
from tests.support.kernels import ROOT

HERE = Path(__file__).parent / "wall"
TARGET = "x86-64-v2"
CONTEST = Contest(WALL.name, TARGET, "any", "rigid", Goal(budget=1e-6), "scalar")


@pytest.fixture(scope="module")
def templates(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("third") / "templates"
    shutil.copytree(ROOT / "templates", folder)
    shutil.copytree(HERE / "templates", folder / "wall")
    return folder


@pytest.fixture
def third(templates: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The registry with one row more, and its templates beside the others."""
    monkeypatch.setattr(registry, "IMPACTS", (*registry.IMPACTS, WALL))
    for module in (environment, banner):
        monkeypatch.setattr(module, "templates_folder", lambda: templates)
    environment.environment.cache_clear()
    yield
    environment.environment.cache_clear()


def checkout(folder: Path) -> Path:
    """The sources of the bench, with a folder more in bench/impacts."""
    shutil.copy2(ROOT / "CMakeLists.txt", folder)
    shutil.copytree(ROOT / "bench", folder / "bench")
    shutil.copytree(HERE / "bench", folder / "bench" / "impacts" / WALL.folder)
    return folder


@pytest.mark.usefixtures("third")
def test_a_third_impact_is_emitted_built_verified_and_called(tmp_path: Path) -> None:
    tool = build_bench_tool(cache_folder(), checkout(tmp_path), WALL)
    bench = Workbench(tool, tmp_path / "cache", {c.code: c for c in find_compilers()})
    made = bench.check(bench.emit(default_kernel(CONTEST), find_target(TARGET)))
    assert isinstance(made, Verified), made.text
    print(made.name, made.verdict.reason, made.verdict.max_rel_error)
    rows = np.array([[0.03, 0.5, 1, 2, 0, 1], [0.03, 0.5, 1, -2, 0, 1], [0.03, 2.0, 1, 2, 0, 1]])
    want = [[1, -1, 0], [1, -2, 1], [1, 2, 2]]
    for batch, way in ((False, Way()), (True, Way()), (True, Way(in_place=True))):
        got = tool.run_kernel(made.library.path, rows, batch=batch, way=way)
        assert np.array_equal(got, want), (batch, way)


@pytest.mark.usefixtures("third")
def test_its_names_are_read_back_and_its_header_may_stand_with_others() -> None:
    variant = default_kernel(CONTEST)
    assert read_question(str(variant.question)) == variant.question
    assert dict(variant.options).keys() == {"fma", "compiler", "flags"}
    assert not WALL.find_scene("any").fixed_steps and baseline(CONTEST, ["gcc"]).stepper.steps
    header = header_of([(BALL_BALL, BALL_BALL.find_scene("any")), (WALL, WALL.find_scene("any"))])
    for name in ("carom_collide_batch(", "carom_wall_collide_batch(", "} carom_wall_params;"):
        assert header.count(name) == 1, name
    assert header.count("CAROM_OK =") == 1


def test_no_file_outside_names_it() -> None:
    rooms = ("generator", "templates", "bench")
    files = [p for room in rooms for p in (ROOT / room).rglob("*") if p.is_file()]
    texts = [p for p in files if p.suffix in {".py", ".j2", ".cpp", ".h", ".toml"}]
    assert not [p for p in texts if "puck" in p.read_text("utf-8")]
