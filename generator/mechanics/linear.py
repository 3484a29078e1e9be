"""Reduced systems: slips are linear in velocities, and these change linearly with impulses.

So the slips obey a linear system with constant coefficients, and the impulse sums follow from the
changes of the slips. SymPy does both steps with exact rationals.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy as sp


def change_of(form: sp.Expr, changes: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
    """Change of a linear form in velocities, where these change so; not expanded."""
    return sum((sp.diff(form, v) * change for v, change in changes.items()), sp.Integer(0))


def sums_from(
    rows: Sequence[sp.Expr], unknowns: Sequence[sp.Symbol], deltas: Sequence[sp.Symbol]
) -> dict[sp.Symbol, sp.Expr]:
    """The unknowns that make each linear form of them its delta; as many rows as unknowns."""
    matrix = sp.Matrix([[row.coeff(unknown) for unknown in unknowns] for row in rows])
    solution = matrix.LUsolve(sp.Matrix(deltas))
    forms = [sp.expand(sp.cancel(value)) for value in solution]
    return dict(zip(unknowns, forms, strict=True))
