"""Where a search of kernels of a cushion looks, and what holds of every impact."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ....evidence.challenge.place import Image, Search, quarter_turn, turned_back
from ....evidence.verification.errors import Array
from ..columns import COLUMNS
from ..models import find_model
from .balls import cases_of
from .charts import GENES, Chart, draw_chart, states_of
from .envelope import Envelope, angles, envelope

_U_S, _U_W, _E_C = (COLUMNS.case.index(name) for name in ("u_s", "u_w", "e_c"))
_PARAMETERS = len(COLUMNS.parameters)


def kinetic_energy(within: Envelope, cases: Array, velocities: Array) -> Array:
    """Over half the mass; `velocities` in rows of v, w."""
    squares = velocities**2
    spin = 0.4 * cases[:, 0] ** 2
    total: Array = squares[:, :3].sum(axis=1) + spin * squares[:, 3:6].sum(axis=1)
    return total


def _cases_of(charts: Sequence[Chart], asked: Sequence[Array], within: Envelope) -> list[Array]:
    return [cases_of(state, layout, within) for state, layout in states_of(charts, asked, within)]


def _mirrored(cases: Array) -> tuple[Array, Array]:
    """In a plane along y: speeds and the normal turn their x over, spins the other two."""
    ball = np.array([-1.0, 1, 1, 1, -1, -1])
    signs = np.concatenate([np.ones(_PARAMETERS), ball, [-1.0, 1.0]])
    return cases * signs, ball


def images(within: Envelope, cases: Array) -> Iterator[Image]:
    """Mirrored and turned."""
    mirrored, signs = _mirrored(cases)
    yield mirrored, lambda got: got * signs
    turned = np.array(cases)
    ball, normal = slice(_PARAMETERS, _PARAMETERS + 6), slice(_PARAMETERS + 6, _PARAMETERS + 8)
    turned[:, ball] = quarter_turn(cases[:, ball])
    turned[:, normal] = np.stack([-cases[:, normal][:, 1], cases[:, normal][:, 0]], axis=-1)
    yield turned, turned_back


def _words(case: Array) -> str:
    nose = case[5] / case[0]
    total = angles(nose, case[_U_S], case[_U_W])
    frictions = f"u_s {case[_U_S]:.6g} u_w {case[_U_W]:.6g} e_c {case[_E_C]:.6g}"
    return f"{frictions} h/R {nose:.6g}, angles {total:.4g}"


SEARCH = Search(
    genes=len(GENES),
    envelope=envelope,
    draw_chart=draw_chart,
    cases_of=_cases_of,
    parameters=(_U_S, _U_W, _E_C),
    together=(),
    images=images,
    energy=kinetic_energy,
    gains_energy=lambda model: not find_model(model).terms.clamped,
    words=_words,
)
