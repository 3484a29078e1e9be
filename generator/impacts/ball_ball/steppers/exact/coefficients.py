"""The coefficients of the equations, as a kernel's text has them."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from .....lowering.printer import ExpressionPrinter, Fma, number
from .pressed import Pressed

_DX, _DZ = sp.symbols("d_x d_z")


@dataclass(frozen=True, kw_only=True)
class Coefficients:
    """Of the slips' rates; numbers, or texts in masses that are given with the call."""

    k_x: float  # c_x' = k_x d_x + ...
    k_z: str  # c_z' = k_z d_z + ...
    per_k_x: str  # their inverses, exact but for one rounding
    per_k_z: str
    drift_x: str
    drift_y: str
    approach_share: str  # of table friction in the change of v_n, as a factor


def coefficients(of: Pressed) -> Coefficients:
    """The texts of a system's coefficients."""
    return Coefficients(
        k_x=float(of.k_x),
        k_z=_value(of.k_z),
        per_k_x=number(1 / of.k_x),
        per_k_z=_value(1 / of.k_z),
        drift_x=printed(-of.recoil * _DX),
        drift_y=printed(Fma(of.k_b, _DZ, of.drive)),
        approach_share=_times(of.approach, ""),
    )


def printed(form: sp.Expr) -> str:
    return ExpressionPrinter(True, fma_name="fma", number_format="real({})").print(form)


def _times(share: sp.Expr, text: str) -> str:
    factor = printed(share)
    return text if share == 1 else f"({factor}) * {text}" if share.is_Add else f"{factor} * {text}"


def _value(form: sp.Expr) -> str:
    """As a literal, or in masses that are given with the call."""
    return repr(float(form)) if form.is_number else printed(form)
