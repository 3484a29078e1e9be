"""Lowering of fixed steps in lanes, as templates/ball_ball/fixed_step/lanes lays them out."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from .....lowering.counts import OperationCounts
from .....lowering.printer import ExpressionPrinter, Fma, number
from .....lowering.statements import Assign, Part, lower
from ... import symbols as s
from ...contact import slips, velocity_changes
from ...reduced import (
    merge_pressed,
    recovery,
    recovery_both,
    reduced_system,
)
from ...terms import ContactTerms
from ..collision_ends import SUMS

KIND = "const Real"
EQUAL = {s.BETA1: 1, s.BETA2: 1}
TABLE_2 = (s.T2X, s.T2Y)
CONTACT = tuple(
    [f"f_{axis}" for axis in "xyz"]
    + [f"{kind}{ball}{axis}" for ball in "12" for kind in "vo" for axis in "xyz"]
)

FIELDS = {"c_x": "f.c_x", "c_z": "f.c_z", "s2x": "f.s_x", "s2y": "f.s_y", "v_n": "f.pace.v"}
FIELDS |= {"dq": "f.pace.dq"}


def _without(form: sp.Expr, symbols: tuple[sp.Symbol, ...]) -> sp.Expr:
    return sp.expand(form.subs(dict.fromkeys(symbols, 0)))


class LaneLowering:
    """Prints the parts of the loops for one contact model; equal masses."""

    def __init__(self, terms: ContactTerms, place_fma: bool) -> None:
        self.terms = terms
        self.place_fma = place_fma

    def before(self, slips_only: bool = False) -> Part:
        """All slips, and the approach velocity too, from the velocities of a contact `b`."""
        member = {v: sp.Symbol(f"b.{v.name}") for v in (*s.V1, *s.V2, *s.O1, *s.O2)}
        forms = [(n, f) for n, f in slips(self.terms).items() if not (slips_only and n == s.V_N)]
        return self._part([Assign(n.name, form.subs(member), KIND) for n, form in forms])

    def _steady_changes(self) -> dict[str, tuple[sp.Expr, sp.Expr]]:
        """What a step with ball 2 pressed adds: by itself, and times `rub`."""
        changes = reduced_system(self.terms, 2).changes
        per_rub = {s.D_X: s.C_X, s.D_Z: s.C_Z}
        per_rub |= {s.T2X: sp.Symbol("p_x", real=True), s.T2Y: sp.Symbol("p_y", real=True)}
        found = {}
        for name in (s.C_X, s.C_Z, s.S2X, s.S2Y, s.V_N):
            change = changes[name]
            fixed = change.coeff(s.DQ) * s.DQ
            found[name.name] = fixed, sp.expand(change - fixed).subs(per_rub)
        return found

    def steady_rates(self) -> Part:
        """What `rub` is multiplied by in a step with ball 2 pressed."""
        rates = {f"{name}_rate": rate for name, (_, rate) in self._steady_changes().items()}
        return self._part([Assign(n, r, KIND) for n, r in rates.items()], self._printer(FIELDS))

    def steady(self) -> Part:
        """One step with ball 2 pressed, from `rub` and the rates."""
        rub = sp.Symbol("rub", real=True)
        assigns = []
        for name, (fixed, _) in self._steady_changes().items():
            now, rate = sp.Symbol(name, real=True), sp.Symbol(f"{name}_rate", real=True)
            fixed = 0 if name == s.V_N.name else fixed
            assigns.append(Assign(name, Fma(rub, rate, now + fixed)))
        return self._part(assigns, self._printer(FIELDS))

    def level(self) -> Part:
        """One step in which no ball is pressed, from d_x."""
        change = _without(reduced_system(self.terms, 2).changes[s.C_X], (*TABLE_2, s.D_Z))
        return self._step({s.C_X: change})

    def chatter(self) -> Part:
        """One step in which either ball may be pressed: d_x, d_z and both balls' t."""
        one, two = (reduced_system(self.terms, pressed).changes for pressed in (1, 2))
        merged = {n: merge_pressed(one[n], two[n]) for n in one}
        merged[s.V_N] -= self.drive() * s.DQ
        return self._step(merged)

    def drive(self) -> sp.Expr:
        """What v_n gains in a step without table friction, in dq."""
        return reduced_system(self.terms, 2).changes[s.V_N].coeff(s.DQ)

    def most_taken(self) -> tuple[float, float]:
        """What a step takes from |c| at most, in u_b dq: by itself, and times u_s more."""
        changes = reduced_system(self.terms, 2).changes
        by_contact = max(abs(changes[n].coeff(d)) for n, d in ((s.C_X, s.D_X), (s.C_Z, s.D_Z)))
        by_table = max(abs(changes[n].coeff(t)) for n, t in ((s.C_X, s.T2X), (s.C_Z, s.T2Y)))
        return float(by_contact), float(by_table)

    def _step(self, changes: Mapping[sp.Symbol, sp.Expr]) -> Part:
        assigns = [Assign(n.name, n + change) for n, change in changes.items() if change != 0]
        own = {n.name: f"f.{n.name}" for n in changes if n != s.V_N}
        return self._part(assigns, self._printer({**FIELDS, **own}))

    def sums(self) -> Part:
        """Sums of impulses with ball 2 pressed, from the changes dc_x to dv_n."""
        names = ("sum_q", "sum_dx", "sum_dz", "sum_tx", "sum_ty")
        forms = recovery(self.terms, 2).sums.values()
        return self._part([Assign(n, f, KIND) for n, f in zip(names, forms, strict=True)])

    def sums_both(self) -> Part:
        """The same where either ball was pressed in turn."""
        forms = recovery_both(self.terms).items()
        return self._part([Assign(SUMS[unknown], form, KIND) for unknown, form in forms])

    def after(self) -> Part:
        """Velocities of a contact `b` after the sums; `up` is what has lifted ball 1."""
        values = {symbol: sp.Symbol(name) for symbol, name in SUMS.items()}
        assigns = []
        for velocity, change in velocity_changes().items():
            member = sp.Symbol(f"b.{velocity.name}")
            assigns.append(Assign(member.name, member + change.subs(EQUAL).subs(values)))
        part = self._part(assigns)
        if not self.terms.lift:
            return part
        lift = ("b.v1z = b.v1z + up;", "b.v2z = b.v2z + (up - sum_dz);")
        return Part((*part.lines, *lift), part.counts + OperationCounts(add=3))

    def per_level_x(self) -> str:
        """d_x for a change of c_x of 1 where no ball is pressed."""
        return number(1 / reduced_system(self.terms, 2).changes[s.C_X].coeff(s.D_X))

    def _printer(self, names: Mapping[str, str] | None = None) -> ExpressionPrinter:
        return ExpressionPrinter(self.place_fma, names, fma_name="fma", number_format="real({})")

    def _part(self, assigns: list[Assign], printer: ExpressionPrinter | None = None) -> Part:
        block = lower(assigns, printer or self._printer())
        return Part(tuple(block.lines), block.counts)
