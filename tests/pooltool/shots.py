"""Random shots of a cue ball at an object ball, as pooltool's objects."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pooltool
import pooltool.constants as const
from pooltool.objects.ball.datatypes import Ball


def new_engine():  # type: ignore[no-untyped-def]
    """pooltool's engine, which has another name and place after 0.6.0."""
    made = getattr(pooltool.evolution, "SimulationEngine", None)
    return made() if made else pooltool.physics.PhysicsEngine()


def touching(angle: float) -> tuple[Ball, Ball]:
    """Two balls at rest that touch, the second one in a direction (rad) from the first."""
    cue = Ball.create("cue", xy=(0.5, 0.5))
    reach = 2 * cue.params.R
    place = (0.5 + reach * np.cos(angle), 0.5 + reach * np.sin(angle))
    return cue, Ball.create("1", xy=place)


def shot(angle: float, cut: float, speed: float, spin: tuple[float, ...]) -> tuple[Ball, Ball]:
    """A cue ball that hits a resting ball; angles in rad, m/s, rad/s."""
    cue, ball = touching(angle)
    cue.state.rvw[1] = speed * np.array([np.cos(angle + cut), np.sin(angle + cut), 0.0])
    cue.state.rvw[2] = spin
    cue.state.s = const.sliding
    return cue, ball


def random_shots(seed: int, count: int) -> Iterator[tuple[Ball, Ball]]:
    """Shots of 0.01 to 15 m/s with any spin; every second object ball moves too."""
    rng = np.random.default_rng(seed)
    made = 0
    while made < count:
        speed = 10 ** rng.uniform(-2, 1.2)
        spin = rng.normal(size=3) * 0.7 * speed / 0.028575
        cue, ball = shot(rng.uniform(0, 2 * np.pi), rng.uniform(-1.569, 1.569), speed, spin)
        if made % 2:
            ball.state.rvw[1, :2] = rng.normal(size=2) * 0.2 * speed
            ball.state.rvw[2] = rng.normal(size=3) * 0.2 * speed / 0.028575
            ball.state.s = const.sliding
        apart = ball.state.rvw[:2] - cue.state.rvw[:2]
        if apart[0] @ apart[1] < 0:  # they approach each other
            made += 1
            yield cue, ball
