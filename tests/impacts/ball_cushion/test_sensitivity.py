"""By how much friction that is off moves exact results of a cushion, whatever kernel there is."""

from __future__ import annotations

import numpy as np
import pytest

from generator.evidence.verification.errors import Array
from generator.evidence.verification.reference import load_reference
from generator.impacts.ball_cushion.columns import COLUMNS
from generator.impacts.ball_cushion.evidence import EVIDENCE
from generator.impacts.ball_cushion.row import BALL_CUSHION
from generator.impacts.ball_cushion.scene import scenes
from generator.impacts.ball_cushion.search import SEARCH
from tests.support.cushion import cushion_tool

SHARE = 1e-5
_U_S, _U_W = (COLUMNS.case.index(name) for name in ("u_s", "u_w"))


def searched(model: str) -> Array:
    """Inputs of the search's charts, over all that the promise is made for."""
    rng = np.random.default_rng(2010)
    within = SEARCH.envelope(scenes()["any"], model, "scene")
    charts = [SEARCH.draw_chart(rng, within) for _ in range(100)]
    drawn = SEARCH.cases_of(charts, [rng.random((30, SEARCH.genes)) for _ in charts], within)
    rows = np.concatenate(drawn)
    return rows[np.isfinite(rows).all(axis=1)]


@pytest.mark.parametrize("model", ["clamped", "printed"])
def test_friction_that_is_off_moves_results_by_no_more_than_the_rules_say(model: str) -> None:
    tool, found = cushion_tool(), searched(model)
    known = load_reference(EVIDENCE.reference).cases
    cases = found if model == "printed" else np.vstack([known, found])
    exact, largest = tool.expect(cases, "screen", model), 0.0
    for columns in ([_U_S], [_U_W], [_U_S, _U_W]):
        moved = cases.copy()
        moved[:, columns] *= 1 - SHARE
        off = EVIDENCE.measure.errors_of(cases, tool.expect(moved, "screen", model), exact)
        answered = np.isfinite(exact).all(axis=1)
        largest = max(largest, float(off.relative[answered].max()) / SHARE)
    allowed = BALL_CUSHION.sensitivity(model).amplification
    print(f"{model}: {largest:.3g} of what friction is off by; the rules say {allowed:g}")
    assert largest <= allowed
