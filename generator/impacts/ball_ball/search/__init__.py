"""Where a search of kernels of two balls looks, and what holds of every collision."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ....evidence.challenge.place import Image, Search, quarter_turn, turned_back
from ....evidence.verification.errors import Array
from ..columns import BALLS, COLUMNS
from ..evidence.scene_cases import mass_ratios
from ..models import find_model
from ..reduced import drives_its_slip
from .balls import cases_of
from .charts import GENES, Chart, draw_chart, places_of, states_of
from .envelope import Envelope, envelope

_FRICTIONS = tuple(COLUMNS.case.index(name) for name in ("u_s1", "u_s2", "u_b", "e_b"))
_U_S1, _U_S2, _U_B, _E_B = _FRICTIONS
_PARAMETERS = len(COLUMNS.parameters)


def kinetic_energy(within: Envelope, cases: Array, velocities: Array) -> Array:
    """Of both balls, over half the mass of ball 2; `velocities` in rows of v1, w1, v2, w2."""
    squares = velocities**2
    spin = 0.4 * cases[:, 0] ** 2
    one = squares[:, 0:3].sum(axis=1) + spin * squares[:, 3:6].sum(axis=1)
    two = squares[:, 6:9].sum(axis=1) + spin * squares[:, 9:12].sum(axis=1)
    total: Array = mass_ratios(within.scene, cases) * one + two
    return total


def _cases_of(charts: Sequence[Chart], asked: Sequence[Array], within: Envelope) -> list[Array]:
    places = [places_of(chart, genes) for chart, genes in zip(charts, asked, strict=True)]
    states = states_of(places, within)
    pairs = zip(states, charts, strict=True)
    return [cases_of(state, chart.layout, within) for state, chart in pairs]


def _mirrored(cases: Array) -> tuple[Array, Array]:
    """In a plane along y: speeds turn their x over, spins the other two."""
    ball = np.array([-1.0, 1, 1, -1, 1, 1, 1, -1, -1])
    signs = np.concatenate([np.ones(_PARAMETERS), ball, ball])
    return cases * signs, np.tile(ball[3:], 2)


def images(within: Envelope, cases: Array) -> Iterator[Image]:
    """Mirrored, turned, and where the scene has no ball of its own swapped."""
    mirrored, signs = _mirrored(cases)
    yield mirrored, lambda got: got * signs
    turned = np.concatenate([cases[:, :_PARAMETERS], quarter_turn(cases[:, _PARAMETERS:])], axis=1)
    yield turned, turned_back
    if within.scene.unrestricted:
        one, two = BALLS
        swapped = np.array(cases)
        swapped[:, one], swapped[:, two] = cases[:, two], cases[:, one]
        swapped[:, [_U_S1, _U_S2]] = cases[:, [_U_S2, _U_S1]]
        yield swapped, lambda got: np.concatenate([got[:, 6:], got[:, :6]], axis=1)


def _words(case: Array) -> str:
    return f"u_b {case[_U_B]:.6g} u_s {case[_U_S1]:.6g} e_b {case[_E_B]:.6g}"


SEARCH = Search(
    genes=len(GENES),
    envelope=envelope,
    draw_chart=draw_chart,
    cases_of=_cases_of,
    parameters=_FRICTIONS,
    together=((1, 0),),  # both frictions of the table
    images=images,
    energy=kinetic_energy,
    gains_energy=lambda model: drives_its_slip(find_model(model).terms),
    words=_words,
)
