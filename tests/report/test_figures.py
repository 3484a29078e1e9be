"""The pictures: the same bytes for the same data, and those of the documentation are up to date."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from generator.cli.main import gen
from generator.evidence.timing.bench_tool import ROOT
from generator.report.figures.speed_error import (
    Point,
    SpeedError,
    pareto_front,
    speed_error_of,
)
from generator.report.figures.speed_error_svg import draw

DATA = ROOT / "docs" / "speed_against_error.json"
PICTURE = DATA.with_suffix(".svg")


def point(ratio: float, error: float, group: str = "exact") -> Point:
    return Point(
        group=group,  # type: ignore[arg-type]
        kernel=f"{group} {ratio} {error}",
        stepper="dp54",
        steps=1000 if group in ("baseline", "euler") else None,
        budget=None if group in ("baseline", "euler") else 1e-6,
        max_rel_error=error,
        max_slipping_error=error,
        cases=100,
        within_budget=True,
        ns=20_000 * ratio,
        ratio=ratio,
        ratio_ci=(ratio, ratio),
    )


def test_pareto_front() -> None:
    slow, fast, beaten = point(1.0, 1e-9), point(0.1, 1e-3), point(1.5, 1e-6)
    assert pareto_front([slow, beaten, fast]) == [fast, slow]
    assert pareto_front([point(0.1, 1e-6), point(0.1, 1e-3)]) == [point(0.1, 1e-6)]


def test_a_picture_has_no_date_and_the_same_bytes_each_time() -> None:
    groups = ("baseline", "euler", "exact", "family")
    points = tuple(point(1 / (i + 1), 10.0 ** -(i + 2), group) for i, group in enumerate(groups))
    measured = SpeedError(
        cpu="a CPU",
        target="zen3",
        scene="any",
        model="mathavan2014",
        compilers={"gcc": "12"},
        points=points,
    )
    first = draw(measured)
    assert first == draw(speed_error_of(json.loads(json.dumps(measured.document()))))
    assert "<dc:date>" not in first and "<dc:creator>" not in first
    assert first.startswith("<?xml") and "\r" not in first


def test_the_committed_picture_is_that_of_its_data() -> None:
    document = json.loads(DATA.read_text("utf-8"))
    assert draw(speed_error_of(document)) == PICTURE.read_text("utf-8"), (
        f"./gen plot --from {DATA.relative_to(ROOT)} --out {PICTURE.relative_to(ROOT)}"
    )


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["--out", "plot.png"], "SVG"),
        (["--out", "nowhere/plot.svg"], "nowhere"),
        (["--out", "plot.svg", "--from", "none.json"], "none.json"),
        (["--out", "plot.svg", "--scene", "pool"], "pool"),
    ],
)
def test_wrong_use_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], named: str
) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(gen, ["plot", *arguments])
    assert result.exit_code == 2
    assert named in result.output + getattr(result, "stderr", "")
    assert not list(tmp_path.iterdir())
