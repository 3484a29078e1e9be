"""Lowering of what is before and after a collision: slips from velocities, velocities from sums.

A scene may know that some velocities are zero before; they are left out of every expression.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy as sp

from ....lowering.counts import OperationCounts
from ....lowering.printer import ExpressionPrinter, number
from ....lowering.statements import Assign, Part, lower
from .. import symbols as s
from ..contact import lift_changes, slips, velocity_changes
from ..masses import EQUAL, Masses, pressed_changes
from ..scene import Scene
from ..terms import ContactTerms

KIND = "const double"
VELOCITIES = (*s.V1, *s.V2, *s.O1, *s.O2)
SUMS = {
    s.DQ: "sum_q",
    s.D_X: "sum_dx",
    s.D_Z: "sum_dz",
    s.T1X: "sum_t1x",
    s.T1Y: "sum_t1y",
    s.T2X: "sum_t2x",
    s.T2Y: "sum_t2y",
}
TABLE = (s.T1X, s.T1Y, s.T2X, s.T2Y)


def at_zero(scene: Scene) -> frozenset[sp.Symbol]:
    """The velocities that are zero before every collision of a scene."""
    zero: set[sp.Symbol] = set()
    if scene.object_ball == "rest":
        zero |= {*s.V2, *s.O2}
    if scene.spin == "none":
        zero |= {*s.O1, *s.O2}
    if scene.spin == "side":
        zero |= {*s.O1[:2], *s.O2[:2]}
    return frozenset(zero)


@dataclass(frozen=True)
class LevelForms:
    """The closed form where no ball is pressed: numbers, and the velocities after."""

    sum_q: str  # share of (1 + e_b) |v_n| that the normal impulse sum is
    stick: str  # share of c_x whose impulse ends the slip
    after: Part


class CollisionEnds:
    """Prints the parts before and after a collision for one contact model and scene."""

    def __init__(
        self,
        terms: ContactTerms,
        masses: Masses,
        zero: Iterable[sp.Symbol],
        place_fma: bool,
        lanes: bool = False,
    ) -> None:
        self.terms = terms
        self.masses = masses
        self.member = {
            v: sp.Integer(0) if v in set(zero) else sp.Symbol(f"b.{v.name}", real=True)
            for v in VELOCITIES
        }
        self.lanes = lanes
        self.kind = "const Real" if lanes else KIND
        self.printer = (
            ExpressionPrinter(place_fma, fma_name="fma", number_format="real({})")
            if lanes
            else ExpressionPrinter(place_fma)
        )

    def slips(self, only: Iterable[str]) -> Part:
        """The slips named, from the velocities before."""
        names = set(only)
        forms = [(n.name, form) for n, form in slips(self.terms).items() if n.name in names]
        return self._part([Assign(n, form.subs(self.member), self.kind) for n, form in forms])

    def relative(self, scale: str = "") -> Part:
        """The components of v1 - v2 (their signs do not matter)."""
        axes = zip("xyz", s.V1, s.V2, strict=True)
        forms = [(f"along_{axis}", (two - one).subs(self.member)) for axis, one, two in axes]
        if scale:
            forms = [(name, form * sp.Symbol(scale, real=True)) for name, form in forms]
        return self._part([Assign(name, form, self.kind) for name, form in forms])

    def velocities(self) -> Part:
        """Velocities after, from the impulse sums of a collision that presses one ball."""
        part = self._velocities(SUMS)
        return Part((*part.lines, *self._lift()), part.counts + self._lift_counts())

    def free_velocities(self) -> Part:
        """As velocities, where the table does nothing."""
        part = self._velocities({k: v for k, v in SUMS.items() if k not in TABLE})
        return Part((*part.lines, *self._lift()), part.counts + self._lift_counts())

    def level(self) -> LevelForms:
        """What holds without vertical slip, whatever the masses: c_x' = k d_x and v_n' = n."""
        nothing = dict.fromkeys((*TABLE, s.D_Z), 0)
        changes = {n: e.subs(nothing) for n, e in pressed_changes(self.terms, EQUAL).items()}
        return LevelForms(
            number(1 / changes[s.V_N].coeff(s.DQ)),
            number(1 / changes[s.C_X].coeff(s.D_X)),
            self._velocities({s.DQ: "sum_q", s.D_X: "sum_dx"}),
        )

    def _velocities(self, sums: dict[sp.Symbol, str]) -> Part:
        values = {symbol: sp.Integer(0) for symbol in SUMS}
        values |= {symbol: sp.Symbol(name, real=True) for symbol, name in sums.items()}
        assigns = []
        for velocity, change in velocity_changes().items():
            change = sp.expand(change.subs(self.masses.values()).subs(values))
            if change != 0:
                assigns.append(Assign(f"b.{velocity.name}", self.member[velocity] + change))
        return self._part(assigns)

    def _lift(self) -> tuple[str, ...]:
        """Vertical velocity of the lifted ball: d_z > 0 lifts ball 1, d_z < 0 ball 2."""
        if not self.terms.lift:
            return ()
        share1 = lift_changes(2)[s.V1[2]].coeff(s.D_Z).subs(self.masses.values())
        share2 = -lift_changes(1)[s.V2[2]].coeff(s.D_Z).subs(self.masses.values())
        positive, negative = "(sum_dz > 0.0 ? sum_dz : 0.0)", "(sum_dz < 0.0 ? sum_dz : 0.0)"
        if self.lanes:
            positive, negative = "larger(sum_dz, real(0.0))", "smaller(sum_dz, real(0.0))"
        up = self._times(share1, positive)
        down = self._times(share2, negative)
        first = "" if self.member[s.V1[2]] == 0 else "b.v1z + "
        second = "-" if self.member[s.V2[2]] == 0 else "b.v2z - "
        return (f"b.v1z = {first}{up};", f"b.v2z = {second}{down};")

    def _times(self, share: sp.Expr, text: str) -> str:
        return text if share == 1 else f"{self.printer.print(share)} * {text}"

    def _lift_counts(self) -> OperationCounts:
        if not self.terms.lift:
            return OperationCounts()
        adds = sum(self.member[v] != 0 for v in (s.V1[2], s.V2[2]))
        return OperationCounts(add=adds, select=2, mul=0 if self.masses.equal else 2)

    def _part(self, assigns: list[Assign]) -> Part:
        block = lower(assigns, self.printer)
        return Part(tuple(block.lines), block.counts)
