"""The measure of error that is used everywhere.

Rows of cases have the columns of an impact (`Columns.case`), rows of outcomes its velocities, then
the status, then, where something is expected, whether the contact sticks. SI units.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import KernelError
from ...impacts.columns import Columns

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

SLIPS, STICKS_YES, NO_END = 0.0, 1.0, 2.0  # values of column sticks; NO_END: the scheme did not end
UNIT = 2.0**-52


class Errors(NamedTuple):
    """Errors of each case. A NaN or infinity that is not expected counts as infinite."""

    absolute: Array  # m/s: the largest of |dv| and R |dw| over all components
    relative: Array  # absolute, divided by the speed that errors are relative to


@dataclass(frozen=True)
class Measure:
    """How far apart outcomes of an impact are. `speed`: of cases, what errors are relative to."""

    columns: Columns
    speed: Callable[[Array], Array]  # m/s, before the collision

    def check_shapes(self, cases: Array, **tables: tuple[Array, int]) -> None:
        """KernelError where a table has not one row a case and at least the columns needed."""
        wanted = {"cases": (cases, len(self.columns.case)), **tables}
        for name, (table, columns) in wanted.items():
            if table.ndim != 2 or table.shape[0] != len(cases) or table.shape[1] < columns:
                raise KernelError(
                    f"{name}: {table.shape} values; expected {len(cases)} rows of {columns}"
                )

    def radius(self, cases: Array) -> Array:
        """What makes spins speeds, m."""
        return cases[:, [self.columns.case.index(self.columns.radius)]]

    def errors_of(self, cases: Array, got: Array, want: Array) -> Errors:
        """Errors of the velocities in `got` against `want`."""
        velocities = slice(self.columns.status)
        difference = component_errors(got[:, velocities], want[:, velocities])
        radius = self.radius(cases)
        difference[:, self.columns.spins_after] *= np.where(
            np.isfinite(radius), np.abs(radius), 1.0
        )
        absolute = np.where(np.isnan(difference), np.inf, difference).max(axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            relative = np.where(absolute == 0, 0.0, absolute / self.speed(cases))
        return Errors(absolute, np.where(np.isnan(relative), np.inf, relative))

    def rounding_of(self, cases: Array) -> Array:
        """What the rounding of speeds alone makes of a result, relative.

        Four units in the last place of the fastest speed of a case (of v or R w): where a body is
        much faster than it approaches, no kernel whose input and output are doubles can be surely
        nearer. The exact result itself moves by as much when a speed changes by its last bit.
        """
        speeds = np.abs(cases[:, self.columns.speeds])
        spins = np.abs(cases[:, self.columns.spins]) * self.radius(cases)
        fastest = np.maximum(speeds.max(axis=1), spins.max(axis=1))
        approach = self.speed(cases)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return np.where(approach > 0, 4 * UNIT * fastest / approach, np.inf)

    @property
    def moving(self) -> tuple[int, ...]:
        """The columns of a case that are speeds or spins."""
        return tuple(sorted((*self.columns.speeds, *self.columns.spins)))


def component_errors(got: Array, want: Array) -> Array:
    """|got - want|; 0 where both are the same infinity or both NaN, infinite where only one is."""
    with np.errstate(invalid="ignore", over="ignore"):
        difference = np.abs(got - want)
    same = (got == want) | (np.isnan(got) & np.isnan(want))
    difference = np.where(np.isnan(difference), np.inf, difference)
    return np.where(same, 0.0, difference)


def nudged(case: Array, count: int, columns: tuple[int, ...]) -> Array:
    """The case, then `count` - 1 like it whose numbers in `columns` changed by a last bit."""
    cases = np.tile(case, (count, 1))
    shape = (count - 1, len(columns))
    signs = np.random.default_rng(1).choice([-1.0, 0.0, 1.0], shape)
    cases[1:, columns] *= 1 + signs * UNIT
    return cases
