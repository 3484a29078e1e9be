"""The seam for a second impact: a row is enough to be listed, and who else names two balls."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from fnmatch import fnmatch
from pathlib import Path

import pytest
from click.testing import CliRunner

from generator.cli.main import gen
from generator.errors import InputError
from generator.impacts import registry
from generator.impacts.ball_ball.columns import BALLS, COLUMNS, SPINS_AFTER, V2, W1, W2_AFTER
from generator.impacts.ball_ball.row import BALL_BALL
from generator.impacts.impact import Impact
from generator.registry.question import find_impact, read_question
from tests.support.kernels import ROOT

OWN = (
    "generator/impacts/ball_*/*",
    "templates/ball_*/*",
    "bench/impacts/ball_*/*",
)
NAMES = re.compile(
    r"\bballs?[12]?\b|\bball_ball\b|\b(?:u_s1|u_s2|u_b|e_b)\b|\[(?:9|12|18)\]", re.IGNORECASE
)
# Files that name two balls outside the impact's own folders, by room, and what of. Counts may only
# fall: a file more fails the test, and so does one less until the count is lowered.
REMAINING = {
    "generator/impacts/__init__.py": (1, "the default's name"),
    "generator/impacts/registry.py": (1, "the rows"),
    "generator/registry/*": (2, "lanes that are balls, an option of the report, and its rules"),
    "generator/clients/*": (1, "what a module has of either impact"),
    "templates/*": (1, "the same, as a table in C++"),
}
SUFFIXES = {".py", ".j2", ".cpp", ".h", ".toml"}


def _cushion(**changes: object) -> Impact:
    return replace(BALL_BALL, name="ball-cushion", text="a ball and a cushion", **changes)


def _naming() -> list[str]:
    """Files outside the impact's folders that name a ball, a parameter or a column count."""
    found = []
    for room in ("generator", "templates", "bench"):
        for path in sorted((ROOT / room).rglob("*")):
            name = path.relative_to(ROOT).as_posix()
            own = any(fnmatch(name, pattern) for pattern in OWN)
            if path.suffix in SUFFIXES and not own and NAMES.search(path.read_text("utf-8")):
                found.append(name)
    return found


def test_a_row_of_the_registry_is_enough_to_be_listed(monkeypatch) -> None:
    monkeypatch.setattr(registry, "IMPACTS", (BALL_BALL, _cushion(has_kernels=False)))
    told = CliRunner().invoke(gen, ["list", "impacts", "--json"])
    assert told.exit_code == 0, told.output
    assert [row["name"] for row in json.loads(told.output)] == ["ball-ball", "ball-cushion"]
    assert registry.find_impact("ball-cushion").text == "a ball and a cushion"


def test_a_row_without_kernels_is_refused_in_a_line_that_says_so(monkeypatch) -> None:
    monkeypatch.setattr(registry, "IMPACTS", (BALL_BALL, _cushion(has_kernels=False)))
    with pytest.raises(InputError) as error:
        find_impact("ball-cushion")
    assert "has no kernels yet; expected one of ball-ball" in str(error.value)
    with pytest.raises(InputError, match="no such impact; there are ball-ball, ball-cushion"):
        registry.find_impact("cue-ball")


def test_a_question_asks_its_own_impact_for_scenes_and_models(monkeypatch) -> None:
    other = _cushion(scene_table=dict, model_table=lambda: ())
    monkeypatch.setattr(registry, "IMPACTS", (BALL_BALL, other))
    asked = "ball-{}/zen3/any/pooltool-e1m06-x1"
    assert read_question(asked.format("ball")).impact == "ball-ball"
    with pytest.raises(ValueError, match="--scene any: no such scene"):
        read_question(asked.format("cushion"))


def test_columns_of_a_row_fit_its_functions() -> None:
    for impact in registry.IMPACTS:
        columns, functions = impact.columns, impact.functions
        assert columns.parameters == tuple(p.name for p in impact.parameters)
        assert functions.batch_in == len(columns.motion)
        assert functions.batch_out == len(columns.velocities) == columns.status
        assert functions.varied in columns.parameters
        assert [status.value for status in impact.statuses] == list(range(len(impact.statuses)))
        assert impact.default_model in [model.name for model in impact.model_table()]


def test_the_columns_of_two_balls_are_where_they_always_were() -> None:
    assert (len(COLUMNS.case), COLUMNS.outcome_width, COLUMNS.expected_width) == (24, 13, 14)
    assert (slice(6, 15), slice(15, 24)) == BALLS
    assert (slice(12, 15), slice(18, 21), slice(9, 12)) == (W1, V2, W2_AFTER)
    assert SPINS_AFTER == [3, 4, 5, 9, 10, 11]


def test_no_other_file_names_two_balls_than_those_that_still_do() -> None:
    naming = _naming()
    print(len(naming), "files outside the impact's folders")
    strangers = [n for n in naming if not any(fnmatch(n, pattern) for pattern in REMAINING)]
    assert not strangers, strangers
    counted = {p: sum(fnmatch(name, p) for name in naming) for p in REMAINING}
    assert counted == {pattern: count for pattern, (count, _) in REMAINING.items()}


def test_what_all_impacts_share_names_none_of_them() -> None:
    shared = {"generator/impacts/scene.py", "generator/impacts/columns.py"}
    assert shared.isdisjoint(_naming())
    assert all((ROOT / Path(name)).is_file() for name in shared)
