"""Scales of a chart: what a number from 0 to 1 stands for in a range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..verification.errors import Array

LEAST = 1e-12  # of a range, on the scales that are logarithmic
NEAR = 12.0  # decades by which an event is approached
_MARGIN = 0.15
Event = Literal["start", "anywhere", "compressed", "end"]


@dataclass(frozen=True)
class Scale:
    """From 0..1 to a range: evenly, by decades from its lower end, or close to a value.

    Evenly: with a margin beyond both ends, which are reached so and not only come near to.
    """

    kind: Literal["linear", "log", "least", "most", "about"]
    low: float
    high: float
    about: float = 0.0
    decades: float = 10.0

    def __call__(self, x: Array) -> Array:
        span = self.high - self.low
        if self.kind == "linear":
            return self.low + span * np.clip(x * (1 + 2 * _MARGIN) - _MARGIN, 0.0, 1.0)
        if self.kind == "log":
            return self.low * (self.high / self.low) ** x
        if self.kind == "least":
            return self.low + span * 10 ** (self.decades * (x - 1))
        if self.kind == "most":
            return self.high - span * 10 ** (-self.decades * x)
        return np.clip(self.about * (1 + signed(x, self.decades)), self.low, self.high)


def signed(x: Array, decades: float) -> Array:
    """From 0..1 to -1..1, by decades from zero on either side."""
    y = 2 * x - 1
    return np.where(np.abs(y) < 0.01, 0.0, np.sign(y) * 10 ** (decades * (np.abs(y) - 1)))


def parameter_scale(rng: np.random.Generator, bounds: tuple[float, float], upper: float) -> Scale:
    """A scale for a range: evenly most often; else by decades from one end. `upper`: how often."""
    low, high = bounds
    if low == high:
        return Scale("linear", low, high)
    draw = rng.random()
    if draw < 0.5:
        return Scale("linear", low, high)
    if draw < 0.5 + upper:
        return Scale("most", low, high, decades=rng.choice([3.0, 12.0]))
    return Scale("least", low, high, decades=rng.choice([3.0, 12.0]))


def slip_scale(rng: np.random.Generator) -> Scale:
    """Of a slip that is of the order of the speed of approach, over it."""
    return Scale("log", 0.1, 5.0) if rng.random() < 0.5 else Scale("log", 1e-2, 20.0)


def near_zero(rng: np.random.Generator) -> Scale:
    """Of a slip that vanishes, over the speed of approach."""
    return Scale("log", LEAST, 1.0) if rng.random() < 0.5 else Scale("log", 1e-5, 1.0)


def approach_at(event: Event, restitution: Array, x: Array) -> tuple[Array, Array]:
    """The speed of approach at an event, over that at the start; how far from the end, else NaN.

    How far is relative to the restitution with which the impact ends right there.
    """
    end = np.full(len(x), np.nan)
    if event == "start":
        return np.ones(len(x)), end
    if event == "anywhere":
        return 1 - (1 + np.maximum(restitution, 1e-3)) * x, end
    if event == "compressed":
        speed = -signed(x, NEAR)
        return np.where(speed > 0, np.minimum(speed, 0.99), speed * restitution), end
    return -np.clip(restitution, LEAST, 1.0), signed(x, NEAR)


def restitution_for(
    drawn: Array, end: Array, back: Array, work: Array, bounds: tuple[float, float]
) -> Array:
    """The restitution that was drawn, or where `end` is no NaN one that ends so far from an event.

    `back`: the work of restitution until the event, negative; `work`: with that of compression.
    """
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        exactly = np.sqrt(back / (work - back))
        return np.where(np.isnan(end), drawn, np.clip(exactly * (1 + end), *bounds))
