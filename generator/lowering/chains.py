"""Long chains of FMAs as statements, one a term: readable, and clang-format is slow on deep nests.

The order of operations stays as it is, and so does every rounding and count.
"""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from .printer import Fma
from .statements import Assign

DEEPEST = 3  # FMAs inside each other that stay one expression


def unfolded(assign: Assign) -> list[Assign]:
    """The assignment, after statements that make the chains in it that are longer than DEEPEST.

    A chain that is the whole value is made in the target itself, which is then no longer const.
    """
    if isinstance(assign.value, str) or not assign.declares:
        return [assign]
    kind = assign.declares.removeprefix("const ")
    if _links(assign.value) > DEEPEST:
        return _steps(assign.target, kind, assign.value)
    before: list[Assign] = []
    value = _without_chains(assign.value, f"{assign.target}_sum", kind, before)
    return [*before, replace(assign, value=value)]


def _links(value: sp.Expr) -> int:
    """FMAs from here along what each adds to."""
    count = 0
    while isinstance(value, Fma):
        value, count = value.args[2], count + 1
    return count


def _steps(target: str, kind: str, value: sp.Expr) -> list[Assign]:
    """`kind target = first;`, then `target = fma(a, b, target);` for each link."""
    links = []
    while isinstance(value, Fma):
        links.append(value.args[:2])
        value = value.args[2]
    so_far = sp.Symbol(target, real=True)
    rest = [Assign(target, Fma(a, b, so_far)) for a, b in reversed(links)]
    return [Assign(target, value, kind), *rest]


def _without_chains(value: sp.Expr, name: str, kind: str, before: list[Assign]) -> sp.Expr:
    """The value with its long chains replaced by names, whose statements go to `before`."""
    if _links(value) > DEEPEST:
        target = f"{name}{len(before) or ''}"
        before += _steps(target, kind, value)
        return sp.Symbol(target, real=True)
    if not value.has(Fma):
        return value
    return value.func(*(_without_chains(a, name, kind, before) for a in value.args))
