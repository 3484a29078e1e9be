"""Whatever stands in a user's file, a reader gives a value or one line that says what is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from generator.api import read_cases
from generator.errors import InputError
from generator.impacts.ball_ball.scene import parse_scene
from generator.registry.names import name_of, variant_of
from generator.targets.target import load_rows
from tests.support.kernels import ROOT

SCENE = (ROOT / "generator" / "impacts" / "ball_ball" / "scenes" / "pool.toml").read_text("utf-8")
TARGETS = (ROOT / "generator" / "targets" / "targets.toml").read_text("utf-8")
CASES = "\n".join(
    (ROOT / "tests" / "data" / "reference" / "inputs.csv").read_text("utf-8").splitlines()[:3]
)
NAME = "ball-ball/zen3/any/pooltool-n1000-x1 fixed fma=fma"
THOROUGH = settings(
    max_examples=300,
    derandomize=True,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


@st.composite
def damaged(draw: st.DrawFn, whole: str) -> str:
    """A text with stretches cut out, doubled or replaced."""
    text = whole
    for _ in range(draw(st.integers(1, 4))):
        first = draw(st.integers(0, len(text)))
        last = draw(st.integers(first, min(len(text), first + 40)))
        text = text[:first] + draw(st.one_of(st.text(max_size=12), st.just(""))) + text[last:]
    return text


def one_line(error: InputError) -> None:
    assert len(str(error).splitlines()) == 1, str(error)


@THOROUGH
@given(text=st.one_of(damaged(SCENE), st.text(max_size=80)))
def test_scenes(text: str) -> None:
    try:
        parse_scene(text, "scene.toml")
    except InputError as error:
        one_line(error)


@THOROUGH
@given(text=st.one_of(damaged(TARGETS), st.text(max_size=80)))
def test_targets(text: str) -> None:
    try:
        load_rows(text, "targets.toml")
    except InputError as error:
        one_line(error)


@THOROUGH
@given(data=st.one_of(damaged(CASES).map(lambda t: t.encode("utf-8", "replace")), st.binary()))
def test_cases(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "cases.csv"
    path.write_bytes(data)
    try:
        table = read_cases(path)
    except InputError as error:
        one_line(error)
    else:
        assert table.rows.shape == (len(table.ids), 24)


@THOROUGH
@given(text=st.one_of(damaged(NAME), st.text(max_size=60)))
def test_names(text: str) -> None:
    try:
        variant = variant_of(text)
    except ValueError:
        return
    assert variant_of(name_of(variant)) == variant


def test_a_quoted_field_of_several_lines_is_shown_on_one(tmp_path: Path) -> None:
    """What the fuzzer found."""
    header, row, *_ = CASES.splitlines()
    path = tmp_path / "cases.csv"
    path.write_text(f'{header}\n{row.split(",")[0]},kind,"0.0\n3,{"9" * 400}"\n', encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_cases(path)
    one_line(caught.value)
    assert len(str(caught.value)) < 200
