"""The equations of the cushion as C++ statements: coefficients of the nose's angle, then rates.

What depends on the angle alone is made once for each impact and has a name; the rates that a step
calls many times are written in these names.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from ....lowering.counts import OperationCounts
from ....lowering.printer import Divide, ExpressionPrinter
from ....lowering.statements import Assign, Part, lower
from .. import symbols as s
from ..contact import slips, table_force, velocity_rates
from ..reduced import (
    recovery,
    slip_rates,
    stuck_cushion,
    stuck_table,
    table_slip_y,
)

KIND = "const double"
ROOT = sp.Symbol("root", real=True)  # the inverse length of a slip
M, G, A, DRIVE = sp.symbols("m g a drive", real=True)
SCALED = (s.V_X, s.O_X, s.O_Y, s.O_Z)


@dataclass(frozen=True)
class Coefficients:
    """What of the rates depends on the angle of the nose alone, by name."""

    forms: Mapping[sp.Symbol, sp.Expr]

    def named(self, form: sp.Expr) -> sp.Expr:
        """A linear form in friction, its coefficients replaced by their names."""
        result = sp.Integer(0)
        rest = sp.expand(form)
        for friction in (s.D_X, s.D_Z, s.T_X, s.T_Y):
            result += self._name(rest.coeff(friction)) * friction
        constant = rest.subs(dict.fromkeys((s.D_X, s.D_Z, s.T_X, s.T_Y), 0))
        return result + self._name(constant)

    def _name(self, coefficient: sp.Expr) -> sp.Expr:
        for symbol, form in self.forms.items():
            if sp.expand(coefficient - form) == 0:
                return symbol
        return coefficient


def coefficients() -> Coefficients:
    """m, g, a and drive, as the rates of the slips have them."""
    rates = slip_rates()
    none = dict.fromkeys((s.D_X, s.D_Z, s.T_X, s.T_Y), 0)
    return Coefficients(
        {
            M: rates[s.C_X].coeff(s.T_X),
            G: rates[s.C_Z].coeff(s.T_Y),
            A: rates[s.C_Z].coeff(s.D_Z),
            DRIVE: rates[s.C_Z].subs(none),
        }
    )


@dataclass(frozen=True)
class ExactParts:
    """Statements of an exact kernel, part by part."""

    angle: Part  # members of Nose, from its sine
    start: Part  # slips before, scaled
    table_slip: Part  # s_y
    nose_friction: Part  # d_x, d_z of a nose that slips
    force: Part  # N
    table_friction: Part  # t_x, t_y of a table that slips
    stuck_nose: Part  # d_x, d_z, N
    stuck_table: Part  # t_x, t_y
    urge: Part  # b_x, b_y: the table slip's rates without its friction
    rates: Part  # rates of c_x, c_z, s_x, v
    balance: Part  # c' = F + K d
    leave: Part  # velocities after
    lane_stuck_nose: Part  # `stuck_nose` in lanes
    lane_balance: Part  # K_zz of `balance` in lanes

    @property
    def step_counts(self) -> OperationCounts:
        """Operations of one evaluation of the rates, both contacts slipping, but for roots."""
        parts = (self.table_slip, self.nose_friction, self.force, self.table_friction, self.rates)
        return sum((part.counts for part in parts), OperationCounts())


_MEMBERS = {"S": "sine", "C": "cosine"}
_FRICTION = {"v_y": "y.v", "N": "f.push", "d_x": "f.d_x", "d_z": "f.d_z"} | {
    "es_x": "f.e_x",
    "es_y": "f.e_y",
}


def exact_parts(place_fma: bool) -> ExactParts:
    inside = ExpressionPrinter(place_fma, _names("n.") | _of("y.", "c_x c_z s_x") | _FRICTION)
    outside = ExpressionPrinter(place_fma, _names("n."))
    lanes = ExpressionPrinter(True, inside.names, fma_name="fma", number_format="real({})")
    named = coefficients()
    rates = slip_rates()
    stuck = stuck_cushion()
    direction = {s.T_X: -s.U_S * s.N * s.ES_X, s.T_Y: -s.U_S * s.N * s.ES_Y}
    without_table = {s.T_X: 0, s.T_Y: 0}

    def part(printer: ExpressionPrinter, forms: Mapping[str, sp.Expr], kind: str = KIND) -> Part:
        block = lower([Assign(name, form, kind) for name, form in forms.items()], printer)
        return Part(tuple(block.lines), block.counts)

    wanted = {"c_x": s.C_X, "c_z": s.C_Z, "s_x": s.S_X}
    moving = {f"rate.{name}": named.named(rates[symbol]) for name, symbol in wanted.items()}
    moving["rate.v"] = named.named(velocity_rates()[s.V_Y])
    return ExactParts(
        angle=part(outside, {str(symbol): form for symbol, form in named.forms.items()}, ""),
        start=part(outside, _start(), ""),
        table_slip=part(inside, {"s_y": table_slip_y()}),
        nose_friction=part(
            inside, {"d_x": -s.U_W * ROOT * s.C_X, "d_z": -s.U_W * ROOT * s.C_Z}, ""
        ),
        force=part(inside, {"N": table_force()}, ""),
        table_friction=part(inside, {"t_x": direction[s.T_X], "t_y": direction[s.T_Y]}, ""),
        stuck_nose=part(inside, _stuck_nose(stuck.force), ""),
        stuck_table=part(
            inside, {str(t): named.named(form) for t, form in stuck_table().items()}, ""
        ),
        urge=part(
            inside,
            {
                "b_x": named.named(rates[s.S_X]).subs(without_table),
                "b_y": named.named(rates[s.S_Y]).subs(without_table),
            },
        ),
        rates=part(inside, moving, ""),
        balance=part(inside, _balance(), KIND),
        leave=part(outside, _leave(), KIND),
        lane_stuck_nose=part(lanes, _stuck_nose(stuck.force), ""),
        lane_balance=part(lanes, {"K_zz": _balance()["K_zz"]}, "const Real"),
    )


def _names(prefix: str) -> dict[str, str]:
    plain = ("m", "g", "a", "drive", "u_s", "u_w")
    return {name: prefix + name for name in plain} | {k: prefix + v for k, v in _MEMBERS.items()}


def _of(prefix: str, names: str) -> dict[str, str]:
    return {name: prefix + name for name in names.split()}


def _start() -> dict[str, sp.Expr]:
    forms = slips()
    return {"c_x": forms[s.C_X], "c_z": forms[s.C_Z], "s_x": forms[s.S_X]}


def _stuck_nose(force: sp.Expr) -> dict[str, sp.Expr]:
    """N first, then friction in terms of it."""
    top, bottom = sp.fraction(sp.together(force))
    rates = slip_rates()
    named = coefficients()
    table = {s.T_X: -s.U_S * s.N * s.ES_X, s.T_Y: -s.U_S * s.N * s.ES_Y}
    d_x = sp.solve(named.named(rates[s.C_X]).subs(table), s.D_X)[0]
    d_z = sp.solve(sp.Eq(s.N, table_force()), s.D_Z)[0]
    return {"N": _divided(top, bottom), "d_x": sp.expand(d_x), "d_z": d_z}


def _divided(top: sp.Expr, bottom: sp.Expr) -> sp.Expr:
    return Divide(sp.expand(top), sp.expand(bottom))


def _balance() -> dict[str, sp.Expr]:
    """c' = (F_x, F_z) + [[K_xx, K_xz], [0, K_zz]] d, while the table slips along e."""
    named, rates = coefficients(), slip_rates()
    table = {s.T_X: -s.U_S * s.N * s.ES_X, s.T_Y: -s.U_S * s.N * s.ES_Y}
    found = {}
    for axis, slip in (("x", s.C_X), ("z", s.C_Z)):
        form = named.named(rates[slip]).subs(table).subs(s.N, table_force())
        form = sp.expand(form)
        found[f"K_{axis}x"], found[f"K_{axis}z"] = form.coeff(s.D_X), form.coeff(s.D_Z)
        found[f"F_{axis}"] = form.subs({s.D_X: 0, s.D_Z: 0})
    if found.pop("K_zx") != 0:
        raise ValueError("friction along the cushion drives the slip up its face")
    return found


def _leave() -> dict[str, sp.Expr]:
    changes = recovery()
    names = {s.V_X: "dv_x", s.O_X: "do_x", s.O_Y: "do_y", s.O_Z: "do_z"}
    return {name: changes[velocity] for velocity, name in names.items()}
