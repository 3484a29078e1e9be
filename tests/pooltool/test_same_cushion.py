"""carom's classes in the place of pooltool's Mathavan2010: the same fields, the same outcomes."""

from __future__ import annotations

from collections.abc import Iterator

import attrs
import numpy as np
import pooltool
import pooltool.constants as const
import pytest
from pooltool.objects.ball.datatypes import Ball
from pooltool.physics.resolve.ball_cushion.mathavan_2010 import (
    Mathavan2010Circular as TheirCircular,
)
from pooltool.physics.resolve.ball_cushion.mathavan_2010 import (
    Mathavan2010Linear as TheirLinear,
)
from shots import new_engine

from carom.pooltool import Mathavan2010Circular, Mathavan2010Linear

PAIRS = {
    "linear": (TheirLinear, Mathavan2010Linear),
    "circular": (TheirCircular, Mathavan2010Circular),
}
TOLERANCE = 1e-9  # m/s; spins as the speed R w of the ball's surface
FLIPS = 0.01  # share of the shots where rounding decides a comparison of the scheme


def cushions(kind: str) -> list:
    return list(getattr(pooltool.Table.default().cushion_segments, kind).values())


def shots(kind: str, seed: int, count: int) -> Iterator[tuple[Ball, object]]:
    """Balls that touch a cushion of a pool table and move into it, with any spin."""
    rng = np.random.default_rng(seed)
    there = cushions(kind)
    for n in range(count):
        cushion = there[n % len(there)]
        ball = Ball.create("cue", xy=(0.0, 0.0))
        angle = rng.uniform(0, 2 * np.pi)
        if kind == "linear":
            normal = np.array([cushion.normal[0], cushion.normal[1], 0.0]) * rng.choice([-1, 1])
            middle = (cushion.p1 + cushion.p2) / 2
        else:
            normal, middle = np.array([-np.cos(angle), -np.sin(angle), 0.0]), cushion.center
        reach = ball.params.R + (cushion.radius if kind == "circular" else 0.0)
        ball.state.rvw[0, :2] = (middle - reach * normal)[:2]
        turn, speed = rng.uniform(-1.5, 1.5), 10 ** rng.uniform(-1.5, 1)
        across = np.array([normal[1], -normal[0], 0.0])
        ball.state.rvw[1] = speed * (np.cos(turn) * normal + np.sin(turn) * across)
        ball.state.rvw[2] = rng.normal(size=3) * 0.7 * speed / ball.params.R
        ball.state.s = const.sliding
        yield ball, cushion


def difference(kind: str, ball: Ball, cushion: object, **fields) -> float:
    theirs, ours = (made(**fields).resolve(ball, cushion)[0] for made in PAIRS[kind])
    assert theirs.state.s == ours.state.s
    units = np.array([[1.0], [1.0], [ball.params.R]])
    return float(np.abs((theirs.state.rvw - ours.state.rvw) * units).max())


@pytest.mark.parametrize("kind", PAIRS)
def test_the_same_fields_with_the_same_defaults(kind: str) -> None:
    theirs, ours = PAIRS[kind]
    for field in attrs.fields(theirs):
        own = getattr(attrs.fields(ours), field.name)
        assert own.init == field.init
        assert getattr(ours(), field.name) == getattr(theirs(), field.name), field.name
    assert list(attrs.asdict(ours()))[:2] == list(attrs.asdict(theirs()))[:2]


@pytest.mark.parametrize("kind", PAIRS)
def test_random_shots_agree(kind: str) -> None:
    found = np.array([difference(kind, *shot) for shot in shots(kind, 2010, 500)])
    flips = found[found > TOLERANCE]
    print(f"{len(found)} shots, {len(flips)} flips; else {found[found <= TOLERANCE].max():.2g} m/s")
    assert len(flips) <= FLIPS * len(found)


@pytest.mark.parametrize("fields", [{"max_steps": 5000, "delta_p": 1e-4}, {"delta_p": 3e-4}])
def test_other_steps_agree(fields: dict) -> None:
    found = np.array([difference("linear", *s, **fields) for s in shots("linear", 7, 100)])
    flips = found[found > TOLERANCE]
    print(f"{fields}: {len(flips)} flips; else {found[found <= TOLERANCE].max():.2g} m/s")
    assert len(flips) <= FLIPS * len(found)


# ---- what is ours alone ----------------------------------------------------------------------


def test_a_straight_roll_comes_back_with_one_share_of_any_speed() -> None:
    (cushion, *_) = cushions("linear")
    kept = []
    for speed in (1e-3, 0.1, 3.0):
        ball = Ball.create("cue", xy=(0.0, 0.0))
        normal = np.array([*cushion.normal[:2], 0.0])
        ball.state.rvw[0, :2] = ((cushion.p1 + cushion.p2) / 2 - ball.params.R * normal)[:2]
        ball.state.rvw[1] = speed * normal
        ball.state.rvw[2] = np.cross([0, 0, 1], normal) * speed / ball.params.R
        ball.state.s = const.rolling
        exact = Mathavan2010Linear(contact_model="clamped", max_error=1e-6)
        after = exact.resolve(ball, cushion)[0].state.rvw[1]
        kept.append(float(np.linalg.norm(after) / speed))
    print(kept)
    assert max(kept) - min(kept) < 2e-6 and 0.5 < kept[0] < 1


@pytest.mark.parametrize("kind", PAIRS)
def test_what_no_kernel_has_is_refused_when_it_is_made(kind: str) -> None:
    made = PAIRS[kind][1]
    for fields, words in (
        ({"contact_model": "mathavan2014"}, "there are clamped, printed, pooltool"),
        ({"contact_model": "pooltool", "max_error": 1e-6}, "fixed steps alone"),
        ({"contact_model": "clamped", "max_error": 1e-15}, "no kernel is as exact"),
        ({"max_steps": 0}, "steps: expected 1"),
        ({"delta_p": 0.0}, "delta_p = 0.0: expected"),
        ({"delta_p": float("nan")}, "delta_p = nan"),
    ):
        with pytest.raises(ValueError, match=words):
            made(**fields)
    model = made(contact_model="clamped", max_error=1e-3)
    with pytest.raises(ValueError, match="there are clamped"):
        model.contact_model = "moon"
    assert model.contact_model == "clamped"


def test_an_engine_takes_them_for_a_whole_shot() -> None:
    engine = new_engine()
    exact = {"contact_model": "clamped", "max_error": 1e-6}
    engine.resolver.ball_linear_cushion = Mathavan2010Linear(**exact)
    engine.resolver.ball_circular_cushion = Mathavan2010Circular(**exact)
    table = pooltool.Table.default()
    balls = pooltool.get_rack(pooltool.GameType.NINEBALL, table)
    shot = pooltool.System(table=table, balls=balls, cue=pooltool.Cue(cue_ball_id="cue"))
    shot.cue.set_state(V0=8.0, phi=pooltool.aim.at_ball(shot, "1"))
    pooltool.simulate(shot, engine=engine, inplace=True)
    met = [e for e in shot.events if "cushion" in e.event_type.value]
    print(f"{len(shot.events)} events, {len(met)} at cushions")
    assert len(met) > 3
