"""Which kernels of a ball and a cushion are worth trying before any has been timed."""

from __future__ import annotations

from ...choice.candidates import Candidates
from ...steppers.budgets import plan_for
from .kernels.exact import STEPPERS


def _tableaus_for(budget: float) -> tuple[str, ...]:
    plan_for(budget)  # the range of budgets is that of all impacts
    return tuple(STEPPERS)


CANDIDATES = Candidates(
    published={"pooltool": {}},  # its scheme with its default settings
    baseline="pooltool",
    fixed=({},),
    fixed_default={},
    fixed_lanes=(),
    tableaus_for=_tableaus_for,
)
