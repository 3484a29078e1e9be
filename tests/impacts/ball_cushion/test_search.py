"""The search for the largest error of a cushion's kernel: its charts, and its way back."""

from __future__ import annotations

import numpy as np

from generator.evidence.challenge.place import found_search
from generator.impacts.ball_cushion.columns import COLUMNS
from generator.impacts.ball_cushion.row import BALL_CUSHION
from generator.impacts.ball_cushion.search import SEARCH
from generator.impacts.ball_cushion.search.balls import cases_of
from generator.impacts.ball_cushion.search.charts import Layout, States, draw_chart, states_of
from generator.impacts.ball_cushion.search.envelope import MOST_ANGLES, Envelope, angles, envelope
from generator.impacts.ball_cushion.search.rewind import C_X, C_Z, S_X, WORK, Frictions, rewind
from tests.support.cushion import cushion_tool


def place(model: str = "clamped", scene: str = "any") -> Envelope:
    return envelope(BALL_CUSHION.find_scene(scene), model, "scene")


def frictions(count: int, rng: np.random.Generator, model: str = "clamped") -> Frictions:
    sine, u_s, u_w = (rng.uniform(0, most, count) for most in (0.45, 0.5, 0.4))
    return Frictions(model, sine, u_s, u_w)


def test_impacts_run_backward_meet_the_place_again() -> None:
    """Without friction the way back is known; with it, two halves of the way are the whole."""
    n, rng = 200, np.random.default_rng(1)
    at = np.zeros((4, n))
    at[:3] = rng.normal(size=(3, n)) * 10.0 ** rng.uniform(-8, 0, (1, n))
    v_y, high = rng.uniform(0.0, 0.9, n), np.ones(n)
    sine = rng.uniform(0, 0.45, n)
    smooth = Frictions("clamped", sine, np.zeros(n), np.zeros(n))
    free = rewind(smooth, at, v_y, high)
    straight = np.abs(free[C_Z] - (at[C_Z] - sine * (1 - v_y))).max()
    work = np.abs(-free[WORK] - (1 - v_y**2) / 2).max()
    rough = frictions(n, rng)
    far = rewind(rough, at, v_y, high)
    half = (v_y + high) / 2
    by_halves = rewind(rough, rewind(rough, at, v_y, half), half, high)
    met = np.isfinite(far).all(axis=0) & np.isfinite(by_halves).all(axis=0)
    apart = np.abs(far - by_halves)[:, met].max()
    print(f"slip off by {straight:.1e}, work by {work:.1e}, halves by {apart:.1e}; {met.sum()} met")
    assert straight < 1e-13 and work < 1e-13
    assert met.sum() > 0.95 * n
    assert apart < 1e-5


def test_cases_have_the_slips_that_were_wanted() -> None:
    rng, within = np.random.default_rng(5), place()
    n = 100
    states = States(
        rng.normal(size=(3, n)), rng.normal(size=n), frictions(n, rng), rng.uniform(0.5, 1, n)
    )
    cases = cases_of(states, Layout(0.7, None, 1.0, 2.0), within)
    nose = cases[:, 5] / cases[:, 0] - 1
    frame = np.stack([cases[:, 13], -cases[:, 12]]), np.stack([cases[:, 12], cases[:, 13]])
    across, along = (
        np.stack([cases[:, c] * f[0] + cases[:, c + 1] * f[1] for c in (6, 9)]) for f in frame
    )
    spin = cases[:, 0] * np.stack([across[1], along[1], cases[:, 11]])
    c_x = across[0] + nose * spin[1] - np.sqrt(1 - nose**2) * spin[2]
    c_z, s_x = spin[0] - nose * along[0], across[0] - spin[1]
    for row, found in ((C_X, c_x), (C_Z, c_z), (S_X, s_x)):
        off = np.abs(found / 2 - states.slips[row]).max()
        print(f"slip {row} off by {off:.1e}")
        assert off < 1e-14


def test_charts_stay_within_the_documented_ranges_and_reach_their_places() -> None:
    rng = np.random.default_rng(3)
    for scene in ("any", "pool"):
        within, sound = place(scene=scene), []
        for _ in range(40):
            chart = draw_chart(rng, within)
            genes = [rng.uniform(-0.5, 1.5, (30, SEARCH.genes))]
            (made,) = states_of([chart], genes, within)
            cases = cases_of(*made, within)
            good = np.isfinite(cases).all(axis=1)
            sound.append(good.mean())
            cases = cases[good]
            for name in ("u_s", "u_w", "e_c"):
                low, high = within.ranges[name]
                values = cases[:, COLUMNS.case.index(name)]
                assert ((values >= low) & (values <= high)).all(), chart
            for case in cases:
                assert angles(case[5] / case[0], case[2], case[3]) <= MOST_ANGLES + 1e-6
        print(f"{scene}: {100 * np.mean(sound):.1f} % of places were reached")
        assert np.mean(sound) > 0.9


def test_printed_is_searched_where_it_has_one_answer() -> None:
    rng, within = np.random.default_rng(4), place("printed")
    charts = [draw_chart(rng, within) for _ in range(20)]
    genes = [rng.uniform(0, 1, (20, SEARCH.genes)) for _ in charts]
    cases = np.concatenate(SEARCH.cases_of(charts, genes, within))
    cases = cases[np.isfinite(cases).all(axis=1)]
    tangent = np.tan(np.arcsin(cases[:, 5] / cases[:, 0] - 1))
    assert len(cases) > 300 and (cases[:, 3] <= tangent * (1 + 1e-12)).all()


def test_images_come_out_alike_and_energy_falls_in_the_oracle() -> None:
    rng, within, tool = np.random.default_rng(6), place(), cushion_tool()
    charts = [draw_chart(rng, within) for _ in range(10)]
    genes = [rng.uniform(0, 1, (10, SEARCH.genes)) for _ in charts]
    cases = np.concatenate(SEARCH.cases_of(charts, genes, within))
    cases = cases[np.isfinite(cases).all(axis=1)]
    own = tool.expect(cases, "exact", "clamped")[:, :6]
    before = SEARCH.energy(within, cases, cases[:, COLUMNS.before])
    growth = ((SEARCH.energy(within, cases, own) - before) / before).max()
    apart = 0.0
    for image, back in SEARCH.images(within, cases):
        other = back(tool.expect(image, "exact", "clamped")[:, :6])
        apart = max(apart, (np.abs(other - own).max(axis=1) / np.sqrt(before)).max())
    print(f"energy grows by {growth:.1e}, images are {apart:.1e} apart")
    assert growth < 1e-14 and apart < 1e-12


def test_every_impact_with_kernels_has_a_search() -> None:
    assert found_search(BALL_CUSHION) is SEARCH
