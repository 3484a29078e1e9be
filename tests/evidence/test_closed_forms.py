"""The closed form that exact batches are timed beside, and the easy set of cases."""

from __future__ import annotations

import numpy as np
import pytest

from generator.choice.cases import TIMING_CASES, Cases
from generator.choice.store import Store
from generator.errors import KernelError
from generator.evidence.timing.bench_tool import ROOT
from generator.impacts.ball_ball.evidence import EASY
from generator.toolchain.build import BuildJob, build
from generator.toolchain.compilers import find_compilers
from generator.toolchain.flags import STRICT
from tests.support.kernels import CACHE, bench_tool

SOURCE = ROOT / "bench" / "impacts" / "ball_ball" / "closed_forms" / "no_table_friction.cpp"
LEAST_SHARE = 0.5  # of all collisions that a table sees, as the mixed set has them


def _impulses(case):
    """Velocities after an inelastic impulse with Coulomb friction, vector by vector."""
    R, _, _, _, u_b, e_b = case[:6]
    r1, v1, w1, r2, v2, w2 = case[6:].reshape(6, 3)
    f = np.array([*(r2 - r1)[:2], 0.0]) / np.hypot(*(r2 - r1)[:2])
    q = (1 + e_b) / 2 * (v1 - v2) @ f
    slip = v1 - v2 + R * np.cross(w1 + w2, f)
    slip -= (slip @ f) * f
    size = np.linalg.norm(slip)
    p = -slip * min(u_b * q / size, 1 / 7) if size > 0 else 0 * slip
    turn = 2.5 / R * np.cross(f, p)
    return np.concatenate([v1 - q * f + p, w1 + turn, v2 + q * f - p, w2 + turn])


@pytest.mark.parametrize("batch", (False, True))
def test_the_closed_form_is_an_inelastic_impulse_with_friction(batch: bool) -> None:
    for compiler in find_compilers():
        job = BuildJob("closed form", {"a.cpp": SOURCE.read_text("utf-8")}, compiler, STRICT)
        library = build(job, CACHE)
        assert not isinstance(library, KernelError)
        cases = bench_tool().make_cases(5, 2000).rows
        got = bench_tool().run_kernel(library.path, cases, batch=batch)
        want = np.array([_impulses(case) for case in cases])
        speeds = np.linalg.norm(cases[:, [9, 10, 11]] - cases[:, [18, 19, 20]], axis=1)
        spins = np.abs(cases[:, [12, 13, 14, 21, 22, 23]]).max(axis=1) * cases[:, 0]
        scale = np.tile(np.repeat([1.0, 0.0], 3), 2) + np.outer(
            cases[:, 0], np.tile(np.repeat([0.0, 1.0], 3), 2)
        )
        off = np.abs((got[:, :12] - want) * scale).max(axis=1) / (speeds + spins)
        print(f"{compiler.code}: {off.max():.1e} of the speeds")
        assert off.max() < 1e-13
        assert not got[:, 12].any()


def test_the_easy_set_has_the_kinds_that_play_mostly_has(tmp_path) -> None:
    tool = bench_tool()
    cases = Cases(tool, Store(tmp_path, False), lambda what, done, of: None)
    easy = cases.timed("any", "mathavan2014", batches=True, of="easy")
    assert cases.sets == ("mixed", "easy")
    assert len(easy) == TIMING_CASES
    kinds = tool.make_cases(1, 4700).kinds
    share = sum(kind in EASY for kind in kinds) / len(kinds)
    print(f"{share:.3f} of the mixed set are easy")
    assert share > LEAST_SHARE
    assert len(np.unique(easy[:, 5])) == 1  # e_b, as a batch shares it
