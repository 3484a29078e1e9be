"""The reduced system of a collision that presses ball 2, by its coefficients."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from .....lowering.lane_algebra import InLanes, Number, given
from .....lowering.printer import Fma
from ... import symbols as s
from ...masses import GIVEN_BETAS, GIVEN_PRESSED


@dataclass(frozen=True)
class Pressed:
    """How impulses change slips and approach: d of contact, t of the table, q the normal one.

    c_x' = k_x d_x - k_xt t_x,  c_z' = k_z d_z + k_zt t_y,  v_n' = 2 q' + approach t_y,
    s_x' = k_f t_x - recoil d_x,  s_y' = k_f t_y + k_b d_z + drive q'.
    """

    k_x: sp.Expr
    k_xt: sp.Expr
    k_z: sp.Expr
    k_zt: sp.Expr
    k_b: sp.Expr
    k_f: sp.Expr
    drive: sp.Expr
    recoil: sp.Expr
    approach: sp.Expr

    @classmethod
    def of(cls, changes: Mapping[sp.Symbol, sp.Expr]) -> Pressed:
        def share(slip: sp.Symbol, impulse: sp.Symbol) -> sp.Expr:
            return changes[slip].coeff(impulse)

        return cls(
            k_x=share(s.C_X, s.D_X),
            k_xt=-share(s.C_X, s.T2X),
            k_z=share(s.C_Z, s.D_Z),
            k_zt=share(s.C_Z, s.T2Y),
            k_b=share(s.S2Y, s.D_Z),
            k_f=share(s.S2X, s.T2X),
            drive=share(s.S2Y, s.DQ),
            recoil=-share(s.S2X, s.D_X),
            approach=share(s.V_N, s.T2Y),
        )

    @property
    def drives(self) -> bool:
        """Does table friction drive the table slip on?"""
        return bool(self.k_f.is_negative)

    @property
    def least_k_z(self) -> float:
        """Over all masses that there may be; it is linear in them."""
        return min(float(self.k_z.subs(GIVEN_PRESSED.beta2, end)) for end in GIVEN_BETAS)

    def drift_x(self, d_x: Number) -> Number:
        """The rate of s beside table friction, from that of contact friction."""
        return InLanes(-self.recoil * d_x.form)

    def drift_y(self, d_z: Number) -> Number:
        return InLanes(Fma(self.k_b, d_z.form, self.drive))

    @staticmethod
    def ratio(top: sp.Expr, bottom: sp.Expr) -> Number:
        return given(sp.cancel(top / bottom))
