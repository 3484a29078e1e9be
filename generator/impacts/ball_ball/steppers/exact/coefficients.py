"""The coefficients of the equations, as a kernel's text has them."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from .....lowering.printer import ExpressionPrinter, Fma, number
from .pressed import Pressed

_DX, _DZ, _DQ = sp.symbols("d_x d_z dq")
_TAIL_DX, _TAIL_DZ, _TAIL_TX, _TAIL_TY = sp.symbols("d_tail_x d_tail_z t_tail_x t_tail_y")


@dataclass(frozen=True, kw_only=True)
class Coefficients:
    """Of the slips' rates; numbers, or texts in masses that are given with the call."""

    k_x: float  # c_x' = k_x d_x + ...
    k_z: str  # c_z' = k_z d_z + ...
    k_zt: str  # c_z' = ... + k_zt t_y
    per_k_x: str  # their inverses, exact but for one rounding
    per_k_z: str
    drift_x: str
    drift_y: str
    tail_t_x: str  # table friction of sticking, as it changes c_x and v_n
    tail_t_y: str
    tail_s_x: str
    tail_s_y: str
    k_xt: str  # c_x' = ... - k_xt t_x
    xt_per_x: str  # k_xt / k_x
    bending: str  # k_x k_zt / k_z
    approach_share: str  # of table friction in the change of v_n, as a factor


def coefficients(of: Pressed) -> Coefficients:
    """The texts of a system's coefficients."""
    return Coefficients(
        k_x=float(of.k_x),
        k_z=_value(of.k_z),
        k_zt=_value(of.k_zt),
        per_k_x=number(1 / of.k_x),
        per_k_z=_value(1 / of.k_z),
        drift_x=printed(-of.recoil * _DX),
        drift_y=printed(Fma(of.k_b, _DZ, of.drive)),
        tail_t_x=_times(of.k_xt, "t_tail_x"),
        tail_t_y=_times(of.approach, "t_tail_y"),
        tail_s_x=printed(Fma(of.k_f, _TAIL_TX, -of.recoil * _TAIL_DX)),
        tail_s_y=printed(Fma(of.k_f, _TAIL_TY, Fma(of.k_b, _TAIL_DZ, of.drive * _DQ))),
        k_xt=_value(of.k_xt),
        xt_per_x=_over(of.k_xt, of.k_x),
        bending=_over(of.k_x * of.k_zt, of.k_z),
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


def _over(top: sp.Expr, bottom: sp.Expr) -> str:
    """A quotient as `_value`; of numbers as doubles divide them."""
    if top.is_number and bottom.is_number:
        return repr(float(top) / float(bottom))
    return printed(sp.cancel(top / bottom))
