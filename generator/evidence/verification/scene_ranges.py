"""Parameters of cases moved into the ranges of a scene, whatever collides."""

from __future__ import annotations

import numpy as np

from ...impacts.columns import Columns
from ...impacts.scene import BaseScene
from .errors import Array

SPREAD = 7919.0  # a value outside a range goes to a place in it that looks random


def set_parameter(cases: Array, columns: Columns, name: str, values: Array | float) -> None:
    """Another parameter for every case, in place; another radius keeps every R w."""
    column = columns.case.index(name)
    if name == columns.radius:
        cases[:, columns.spins] *= (cases[:, column] / values)[:, None]
    cases[:, column] = values


def into(values: Array, low: float, high: float) -> Array:
    """The values, those outside a range moved into it."""
    place = np.abs(values * SPREAD) % 1.0
    return np.where((values >= low) & (values <= high), values, low + (high - low) * place)


def move_parameters(cases: Array, columns: Columns, scene: BaseScene) -> None:
    """Into what the scene fixes and ranges over, in place."""
    for column, name in enumerate(columns.parameters):
        if name in scene.fixed:
            set_parameter(cases, columns, name, np.full(len(cases), scene.fixed[name]))
        elif name in scene.ranges:
            set_parameter(cases, columns, name, into(cases[:, column], *scene.ranges[name]))
