"""Time of a collision in both resolvers, interleaved: python time_resolvers.py [SECONDS]."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np
from pooltool.physics.resolve.ball_ball.frictional_mathavan import FrictionalMathavan as Theirs
from shots import random_shots

from carom.pooltool import FrictionalMathavan as Ours

RESOLVERS = {
    "pooltool's own": Theirs(),
    "carom, N = 1000": Ours(),
    "carom, max_error=1e-6": Ours(max_error=1e-6),
    "carom, mathavan2014, max_error=1e-6": Ours(contact_model="mathavan2014", max_error=1e-6),
}


def seconds_of(resolve: Callable, shots: list) -> float:
    """Seconds a collision, solving alone, over all shots once; copies are not counted."""
    copies = [(cue.copy(), ball.copy()) for cue, ball in shots]
    begun = time.perf_counter()
    for cue, ball in copies:
        resolve(cue, ball)
    return (time.perf_counter() - begun) / len(shots)


def main(seconds: float) -> None:
    """Print the median time of each resolver and of its ratio to pooltool's own."""
    shots = list(random_shots(7735, 100))
    names = list(RESOLVERS)
    rounds: list[list[float]] = []
    for resolver in RESOLVERS.values():
        seconds_of(resolver.solve, shots[:2])  # numba compiles
    end = time.monotonic() + seconds
    while time.monotonic() < end or len(rounds) < 3:
        order = names if len(rounds) % 2 else names[::-1]
        taken = {name: seconds_of(RESOLVERS[name].solve, shots) for name in order}
        rounds.append([taken[name] for name in names])
    table = np.array(rounds)
    for index, name in enumerate(names):
        ratio = np.median(table[:, index] / table[:, 0])
        print(f"{name:38} {np.median(table[:, index]) * 1e6:9.2f} us a collision  {ratio:.4f}")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 10.0)
