"""The picture of docs/models.md: its bytes, and the figures that the page quotes."""

from __future__ import annotations

import numpy as np
import pytest

from generator.impacts.ball_cushion.picture import ANGLES, SAID, Gaps, draw, model_gaps
from tests.support.cushion import cushion_tool
from tests.support.kernels import ROOT

DOCS = ROOT / "docs"


@pytest.fixture(scope="module")
def gaps() -> Gaps:
    return model_gaps(cushion_tool())


def test_the_committed_picture_is_that_of_the_code(gaps: Gaps) -> None:
    assert draw(gaps) == (DOCS / "cushion_models.svg").read_text("utf-8"), (
        "./gen plot --models --impact ball-cushion --out docs/cushion_models.svg"
    )


def test_the_page_quotes_what_is_computed(gaps: Gaps) -> None:
    page = " ".join((DOCS / "models.md").read_text("utf-8").split())
    told = [f"{gaps.exact:.4f}", *(f"{ratio:.3f}" for ratio in gaps.rebound)]
    for name in ("pool: pooltool's classes", "snooker: pooltool's classes", "snooker: printed"):
        apart = 100 * gaps.over_angle[name]
        told += [f"{np.median(apart):.2g} %", f"{apart.max():.2g} %"]
    print(told)
    assert [figure for figure in told if figure not in page] == []


def test_the_scheme_is_off_by_more_than_the_speed_where_a_ball_is_slow(gaps: Gaps) -> None:
    assert gaps.rebound[SAID.index(1e-3)] > 5
    assert gaps.exact == pytest.approx(0.8042818992213045, abs=1e-13)
    beyond = np.degrees(np.arccos((0.028 / 0.026194 - 1) / 0.5)) + 0.5  # where nothing lifts
    assert gaps.over_angle["snooker: printed"][beyond < ANGLES].max() < 1e-4
