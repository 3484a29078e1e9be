"""A break from the cue's stroke until all balls rest, with both classes."""

from __future__ import annotations

import random
from dataclasses import dataclass

import numpy as np
import pooltool as pt
import pooltool.constants as const
from pooltool.events import EventType
from pooltool.physics.resolve.ball_ball.frictional_mathavan import FrictionalMathavan as Theirs
from shots import new_engine

from carom.pooltool import FrictionalMathavan as Ours


@dataclass(frozen=True)
class Break:
    """What happened, and where the balls ended."""

    kinds: tuple[tuple[EventType, tuple[str, ...]], ...]
    times: np.ndarray
    places: np.ndarray

    @property
    def collisions(self) -> int:
        return sum(kind == EventType.BALL_BALL for kind, _ in self.kinds)


def break_with(resolver) -> Break:  # type: ignore[no-untyped-def]
    """The same nine-ball break of 8 m/s by a resolver."""
    random.seed(9)
    np.random.seed(9)
    table = pt.Table.default()
    balls = pt.get_rack(pt.GameType.NINEBALL, table, spacing_factor=1e-3)
    system = pt.System(table=table, balls=balls, cue=pt.Cue(cue_ball_id="cue"))
    system.strike(V0=8, phi=pt.aim.at_ball(system, "1"))
    engine = new_engine()
    engine.resolver.ball_ball = resolver
    pt.simulate(system, engine=engine, inplace=True)
    at_rest = (const.stationary, const.pocketed)
    assert all(ball.state.s in at_rest for ball in system.balls.values())
    kinds = tuple((event.event_type, tuple(event.ids)) for event in system.events)
    times = np.array([event.time for event in system.events])
    places = np.array([ball.state.rvw[0] for ball in system.balls.values()])
    return Break(kinds, times, places)


def test_a_break_is_the_same_from_start_to_end() -> None:
    theirs, ours = break_with(Theirs()), break_with(Ours())
    apart = float(np.abs(theirs.places - ours.places).max())
    late = float(np.abs(theirs.times - ours.times).max()) if theirs.kinds == ours.kinds else np.inf
    print(
        f"{len(theirs.kinds)} events, {theirs.collisions} collisions of balls; times differ by at "
        f"most {late:.2g} s, final places by {apart:.2g} m"
    )
    assert theirs.collisions >= 10
    assert theirs.kinds == ours.kinds
    # Every collision multiplies a difference by about ten; these are of 1e-7 at first.
    assert late < 1e-2 and apart < 1e-2


def test_a_break_ends_with_every_model() -> None:
    for name in ("bottom_slip", "mathavan2014"):
        done = break_with(Ours(contact_model=name, max_error=1e-6))
        print(f"{name}: {len(done.kinds)} events, {done.collisions} collisions")
        assert done.collisions >= 10 and np.isfinite(done.places).all()
