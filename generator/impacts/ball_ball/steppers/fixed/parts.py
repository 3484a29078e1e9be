"""Lowering of the fixed-step scheme (pooltool's and the report's): one part of an iteration each.

Source: Mathavan, Jackson, Parkin (2014), Sect. 4; step dP = (1 + e_b) M |v_n| / (2 N) as pooltool
and the report take it. The parts are printed here; templates/fixed_step lays them out.
"""

from __future__ import annotations

import sympy as sp

from .....lowering.counts import OperationCounts
from .....lowering.printer import Divide, ExpressionPrinter, Sqrt
from .....lowering.statements import Assign, Part, lower
from .....registry.variant import Variant
from ... import symbols as s
from ...contact import lift_changes, slips, velocity_changes
from ...terms import ContactTerms

REAL = "double"
SLIP_SYMBOLS = {"c": (s.C_X, s.C_Z), "s1": (s.S1X, s.S1Y), "s2": (s.S2X, s.S2Y)}
TABLE = {1: (s.T1X, s.T1Y), 2: (s.T2X, s.T2Y)}
SPIN_SYMBOLS = (*s.O1, *s.O2)
# What the contact slip is made of, in lanes of balls too.
CONTACT_VELOCITIES = {
    name.format(ball) for name in ("v{}x", "o{}x", "o{}z") for ball in ("1", "2", "_")
}
HALF_C = sp.Rational(5, 2)  # R^2 m / I: what an impulse at the surface does to the spin speed

K = sp.Symbol("k_b", real=True)  # u_b dq, the friction speed of one step
DP = sp.Symbol("dP", real=True)
C_INERTIA = sp.Symbol("C", real=True)  # 5 / (2 M R)
U_TABLE = {1: s.U_S1, 2: s.U_S2}
PARAMETER_NAMES = {name: f"p.{name}" for name in ("R", "M", "u_s1", "u_s2", "u_b", "e_b")}


# v_n is made from the two velocities, as pooltool does: so it is rounded alike, and ties agree.
APPROACH = Assign(s.V_N.name, s.V2[1] - s.V1[1])


def approach_changes(pressed: tuple[int, ...]) -> dict[sp.Symbol, sp.Expr]:
    """Changes of v1y and v2y; only the balls named get friction from the table."""
    idle = {t: 0 for ball in (1, 2) if ball not in pressed for t in TABLE[ball]}
    equal = {s.BETA1: 1, s.BETA2: 1}
    changes = velocity_changes()
    return {v: sp.expand(changes[v].subs(equal).subs(idle)) for v in (s.V1[1], s.V2[1])}


def _spin_names(physical: bool) -> dict[str, str]:
    """In physical units the loop carries w in rad/s, else the spin speed o = R w in m/s."""
    return {o.name: o.name.replace("o", "w", 1) for o in SPIN_SYMBOLS} if physical else {}


def _array_names() -> dict[str, str]:
    names = {"c_x": "c[0]", "c_z": "c[1]"}
    for ball in "12":
        for index, axis in enumerate("xyz"):
            names[f"v{ball}{axis}"] = f"v{ball}[{index}]"
            names[f"o{ball}{axis}"] = f"o{ball}[{index}]"
            names[f"w{ball}{axis}"] = f"w{ball}[{index}]"
        names[f"s{ball}x"], names[f"s{ball}y"] = f"s{ball}[0]", f"s{ball}[1]"
    return names


class FixedStepLowering:
    """Prints the parts of one variant of the fixed-step scheme."""

    def __init__(self, variant: Variant, terms: ContactTerms) -> None:
        self.variant = variant
        self.terms = terms
        self.physical = variant["reuse"] in ("keep", "recompute")
        spins = _spin_names(self.physical)
        arrays = _array_names() if variant["store"] == "arrays" else {}
        spelled = {name: arrays.get(text, text) for name, text in spins.items()}
        fma = variant["fma"] == "fma"
        self.names = {**PARAMETER_NAMES, **arrays, **spelled}
        self.printer = ExpressionPrinter(fma, self.names)
        self.plain = ExpressionPrinter(fma, PARAMETER_NAMES)
        self.lanes = ExpressionPrinter(fma, PARAMETER_NAMES, fma_name="fma_pair")
        self.sqrt_divide = variant["rsqrt"] == "div"

    # -- state ---------------------------------------------------------------------------------

    def slips_of_state(self, declare: str = "", only: tuple[str, ...] | None = None) -> Part:
        """The slips (or those named), made from the velocities."""
        forms = [(n, f) for n, f in slips(self.terms).items() if only is None or n.name in only]
        in_w = {o: s.R * o for o in SPIN_SYMBOLS} if self.physical else {}
        return self.part([Assign(n.name, form.subs(in_w), declare) for n, form in forms])

    def slips_of_contact(self, suffix: str = "", only: tuple[str, ...] | None = None) -> Part:
        """The slips (or those named) before the loop, from the contact's velocities."""
        forms = [(n, f) for n, f in slips(self.terms).items() if only is None or n.name in only]
        member = {v: sp.Symbol(f"b.{v.name}", real=True) for v in (*s.V1, *s.V2, *SPIN_SYMBOLS)}
        printer = ExpressionPrinter(self.variant["fma"] == "fma")
        assigns = [Assign(n.name + suffix, form.subs(member), f"const {REAL}") for n, form in forms]
        return self.part(assigns, printer)

    # -- roots ---------------------------------------------------------------------------------

    def root(self, tag: str, declare: str) -> Part:
        """Length or inverse length of one slip by the variant's method."""
        x, y = SLIP_SYMBOLS[tag]
        square = x**2 + y**2
        if self.sqrt_divide:
            return self.part([Assign(f"l_{tag}", Sqrt(square), declare)])
        block = lower([Assign(f"n_{tag}", square, declare)], self.printer)
        n = f"n_{tag}"
        target = f"i_{tag}"
        text, counts = self.inverse_root(n, tag)
        head = "" if self.refines else (f"{declare} " if declare else "")
        block.lines.append(f"{head}{target} = {text};")
        return Part(tuple(block.lines), block.counts + counts)

    @property
    def recomputes(self) -> bool:
        """Are slips made anew in each iteration?"""
        return self.variant["reuse"] == "recompute"

    @property
    def refines(self) -> bool:
        return self.variant["rsqrt"] in ("prev", "ahead")

    def inverse_root(self, n: str, tag: str) -> tuple[str, OperationCounts]:
        method = self.variant["rsqrt"]
        if method == "inv":
            return f"exact_rsqrt({n})", OperationCounts(div=1, sqrt=1, compare=1)
        fused = self.variant["fma"] == "fma"
        if method in ("est1", "est2"):
            steps = int(method[-1])
            newton = OperationCounts(mul=2, fma=2) if fused else OperationCounts(mul=4, add=2)
            return f"rsqrt_newton{steps}({n})", OperationCounts(estimate=1) + newton * steps
        guess = f"g_{tag}" if method == "ahead" else f"i_{tag}"
        bound = "kRefineContact" if tag == "c" else "kRefineTable"
        check = OperationCounts(add=1, mul=5)
        last = OperationCounts(fma=1) if fused else OperationCounts(add=1, mul=1)
        return f"refined({n}, {guess}, {bound})", check + last

    def is_zero(self, tag: str) -> str:
        """Condition that a slip counts as zero: below 1e-16 m/s at the contact, 0 at the table."""
        if tag == "c":
            return "l_c < kNoSlip" if self.sqrt_divide else "n_c < kNoSlip * kNoSlip"
        return f"l_{tag} == 0.0" if self.sqrt_divide else f"n_{tag} == 0.0"

    # -- impulses ------------------------------------------------------------------------------

    def _unit(self, component: sp.Symbol, tag: str) -> sp.Expr:
        if self.sqrt_divide:
            return Divide(component, sp.Symbol(f"l_{tag}", real=True))
        return component * sp.Symbol(f"i_{tag}", real=True)

    def friction(self, name: str) -> sp.Expr:
        """d_x or d_z: ball-ball friction of one step."""
        component = s.C_X if name == "d_x" else s.C_Z
        scale = s.U_B * DP if self.physical else K
        if self.sqrt_divide:
            return Divide(-scale * component, sp.Symbol("l_c", real=True))
        return -scale * component * sp.Symbol("i_c", real=True)

    def friction_part(self, name: str, declare: str = "") -> Part:
        return self.part([Assign(name, self.friction(name), declare)])

    def table(self, ball: int, declare: str = "") -> Part:
        """Table friction on the pressed ball; d_z > 0 presses ball 2, d_z < 0 ball 1."""
        sign = -1 if ball == 2 else 1
        x, y = SLIP_SYMBOLS[f"s{ball}"]
        t_x, t_y = TABLE[ball]
        u_s = U_TABLE[ball]
        return self.part(
            [
                Assign(t.name, sign * u_s * self._unit(c, f"s{ball}") * s.D_Z, declare)
                for t, c in ((t_x, x), (t_y, y))
            ]
        )

    # -- updates -------------------------------------------------------------------------------

    def update(self, pressed: tuple[int, ...] = (1, 2)) -> Part:
        """All velocities after one step; balls that are not pressed get nothing from the table."""
        idle = {t: 0 for ball in (1, 2) if ball not in pressed for t in TABLE[ball]}
        equal = {s.BETA1: 1, s.BETA2: 1}
        assigns = []
        for symbol, change in velocity_changes().items():
            change = sp.expand(change.subs(equal).subs(idle))
            if change == 0:
                continue
            assigns.append(Assign(symbol.name, symbol + self._scaled(symbol, change)))
        return self.part(self.in_order(assigns))

    @property
    def chain_first(self) -> bool:
        return self.variant["order"] == "chain"

    def in_order(self, assigns: list[Assign]) -> list[Assign]:
        """With order=chain the velocities that make the contact slip come first (stable)."""
        if not self.chain_first:
            return assigns
        return sorted(assigns, key=lambda a: a.target not in CONTACT_VELOCITIES)

    def _scaled(self, symbol: sp.Symbol, change: sp.Expr) -> sp.Expr:
        if not self.physical:
            return change
        change = change.subs(s.DQ, DP)
        if symbol in SPIN_SYMBOLS:
            return C_INERTIA * sp.expand(change / HALF_C)
        return Divide(change, s.M)

    def lift(self, pressed: int) -> Part:
        """Vertical velocities after one step, for models with lift."""
        if not self.terms.lift:
            return Part((), OperationCounts())
        equal = {s.BETA1: 1, s.BETA2: 1}
        changes = {v: dv.subs(equal) for v, dv in lift_changes(pressed).items() if dv != 0}
        scaled = {v: Divide(dv, s.M) if self.physical else dv for v, dv in changes.items()}
        return self.part([Assign(v.name, v + dv) for v, dv in scaled.items()])

    def part(self, assigns: list[Assign], printer: ExpressionPrinter | None = None) -> Part:
        block = lower(assigns, printer or self.printer)
        return Part(tuple(block.lines), block.counts)
