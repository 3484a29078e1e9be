"""Lowering of the fixed-step scheme (pooltool's and the report's): one part of an iteration each.

Source: Mathavan, Jackson, Parkin (2014), Sect. 4; step dP = (1 + e_b) M |v_n| / (2 N) as pooltool
and the report take it. The parts are printed here; templates/fixed_step lays them out.
"""

from __future__ import annotations

import re

import sympy as sp

from ...impacts.ball_ball import symbols as s
from ...impacts.ball_ball.contact import lift_changes, slips, velocity_changes
from ...impacts.ball_ball.reduced import (
    DELTAS,
    DELTAS_BOTH,
    merge_pressed,
    recovery,
    recovery_both,
    reduced_system,
)
from ...impacts.ball_ball.terms import ContactTerms
from ...lowering.counts import OperationCounts
from ...lowering.printer import Divide, ExpressionPrinter, Sqrt, number
from ...lowering.statements import Assign, Block, Part, lower
from ...registry.variant import Variant

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


def _approach_changes(pressed: tuple[int, ...]) -> dict[sp.Symbol, sp.Expr]:
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

    def state_symbols(self) -> tuple[sp.Symbol, ...]:
        """Linear and angular velocities that the full state carries."""
        vertical = (s.V1[2], s.V2[2]) if self.terms.lift else ()
        return (s.V1[0], s.V1[1], s.V2[0], s.V2[1], *SPIN_SYMBOLS, *vertical)

    def slips_of_state(self, declare: str = "", only: tuple[str, ...] | None = None) -> Part:
        """The slips (or those named), made from the velocities."""
        forms = [(n, f) for n, f in slips(self.terms).items() if only is None or n.name in only]
        in_w = {o: s.R * o for o in SPIN_SYMBOLS} if self.physical else {}
        return self._part([Assign(n.name, form.subs(in_w), declare) for n, form in forms])

    def slips_of_contact(self, suffix: str = "", only: tuple[str, ...] | None = None) -> Part:
        """The slips (or those named) before the loop, from the contact's velocities."""
        forms = [(n, f) for n, f in slips(self.terms).items() if only is None or n.name in only]
        member = {v: sp.Symbol(f"b.{v.name}", real=True) for v in (*s.V1, *s.V2, *SPIN_SYMBOLS)}
        printer = ExpressionPrinter(self.variant["fma"] == "fma")
        assigns = [Assign(n.name + suffix, form.subs(member), f"const {REAL}") for n, form in forms]
        return self._part(assigns, printer)

    # -- roots ---------------------------------------------------------------------------------

    def root(self, tag: str, declare: str) -> Part:
        """Length or inverse length of one slip by the variant's method."""
        x, y = SLIP_SYMBOLS[tag]
        square = x**2 + y**2
        if self.sqrt_divide:
            return self._part([Assign(f"l_{tag}", Sqrt(square), declare)])
        block = lower([Assign(f"n_{tag}", square, declare)], self.printer)
        n = f"n_{tag}"
        target = f"i_{tag}"
        text, counts = self._inverse_root(n, tag)
        head = "" if self.refines else (f"{declare} " if declare else "")
        block.lines.append(f"{head}{target} = {text};")
        return Part(tuple(block.lines), block.counts + counts)

    @property
    def refines(self) -> bool:
        return self.variant["rsqrt"] in ("prev", "ahead")

    def _inverse_root(self, n: str, tag: str) -> tuple[str, OperationCounts]:
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
        return self._part([Assign(name, self.friction(name), declare)])

    def table(self, ball: int, declare: str = "") -> Part:
        """Table friction on the pressed ball; d_z > 0 presses ball 2, d_z < 0 ball 1."""
        sign = -1 if ball == 2 else 1
        x, y = SLIP_SYMBOLS[f"s{ball}"]
        t_x, t_y = TABLE[ball]
        u_s = U_TABLE[ball]
        return self._part(
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
        return self._part(self._in_order(assigns))

    @property
    def _chain_first(self) -> bool:
        return self.variant["order"] == "chain"

    def _in_order(self, assigns: list[Assign]) -> list[Assign]:
        """With order=chain the velocities that make the contact slip come first (stable)."""
        if not self._chain_first:
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
        return self._part([Assign(v.name, v + dv) for v, dv in scaled.items()])

    # -- the reduced loop ----------------------------------------------------------------------

    def reduced_update(self, pressed: int) -> Part:
        """Slips after one step with one pressed ball, as derived (coefficients from SymPy)."""
        changes = self._pressed_changes(pressed)
        assigns = [Assign(n.name, n + change) for n, change in changes.items()]
        return self._part([*assigns, APPROACH])

    def reduced_factored(self, pressed: int) -> Part:
        """As reduced_update, the inverse lengths multiplied in last: the critical chain is short.

        n' = n + fixed + i_c * (contact part) + i_c i_s * (table part), where neither part needs an
        inverse length.
        """
        changes = self._pressed_changes(pressed)
        x, y = SLIP_SYMBOLS[f"s{pressed}"]
        t_x, t_y = TABLE[pressed]
        h_x, h_z, g_x, g_y, i_c, i_cs = sp.symbols("h_x h_z g_x g_y i_c i_cs", real=True)
        push = (-1 if pressed == 2 else 1) * U_TABLE[pressed]
        kind = f"const {REAL}"
        assigns = [
            Assign("h_x", -K * s.C_X, kind),
            Assign("h_z", -K * s.C_Z, kind),
            Assign("g", push * h_z, kind),
            Assign("g_x", sp.Symbol("g", real=True) * x, kind),
            Assign("g_y", sp.Symbol("g", real=True) * y, kind),
            Assign("i_cs", i_c * sp.Symbol(f"i_s{pressed}", real=True), kind),
        ]
        for name, change in changes.items():
            value = name + change.coeff(s.DQ) * s.DQ
            contact = sp.expand(change.coeff(s.D_X) * h_x + change.coeff(s.D_Z) * h_z)
            table = sp.expand(change.coeff(t_x) * g_x + change.coeff(t_y) * g_y)
            for factor, form in ((i_c, contact), (i_cs, table)):
                if form != 0:
                    assigns.append(Assign(name.name, value + factor * form))
                    value = name
            if value != name:
                assigns.append(Assign(name.name, value))
        return self._part([*assigns, APPROACH])

    def _pressed_changes(self, pressed: int) -> dict[sp.Symbol, sp.Expr]:
        changes = reduced_system(self.terms, pressed).changes
        slip = SLIP_SYMBOLS[f"s{pressed}"]
        approach = _approach_changes((pressed,))
        contact = {n: changes[n] for n in (s.C_X, s.C_Z)}
        table = {n: changes[n] for n in slip}
        if self._chain_first:
            return {**contact, **table, **approach}
        return {**approach, **table, **contact}

    def reduced_both(self) -> Part:
        """Slips after one step, table friction of both balls given (one of them zero)."""
        one, two = (reduced_system(self.terms, p).changes for p in (1, 2))
        merged = {n: merge_pressed(one[n], two[n]) for n in one if n != s.V_N}
        approach = _approach_changes((1, 2))
        merged = {**merged, **approach} if self._chain_first else {**approach, **merged}
        assigns = [Assign(n.name, n + change) for n, change in merged.items()]
        return self._part([*assigns, APPROACH])

    def recover_pressed(self, pressed: int) -> Part:
        """Impulse sums from the changes of the slips: SymPy's solution of the linear system."""
        forms = recovery(self.terms, pressed).sums
        slip = SLIP_SYMBOLS[f"s{pressed}"]
        before = (s.C_X, s.C_Z, *slip, s.V_N)
        assigns = [
            Assign(delta.name, now - sp.Symbol(f"{now.name}_0", real=True), f"const {REAL}")
            for delta, now in zip(DELTAS, before, strict=True)
        ]
        sums = {
            s.DQ: "sum_q",
            s.D_X: "sum_dx",
            s.D_Z: "sum_dz",
            TABLE[pressed][0]: "sum_tx",
            TABLE[pressed][1]: "sum_ty",
        }
        for unknown, name in sums.items():
            assigns.append(Assign(name, forms[unknown], f"const {REAL}"))
        return self._part(assigns)

    def recover_both(self) -> Part:
        """As recover_pressed, where either ball may have been pressed in turn."""
        forms = recovery_both(self.terms)
        now = (s.C_X, s.C_Z, s.S1X, s.S1Y, s.S2X, s.S2Y, s.V_N)
        assigns = [
            Assign(delta.name, name - sp.Symbol(f"{name.name}_0", real=True), f"const {REAL}")
            for delta, name in zip(DELTAS_BOTH, now, strict=True)
        ]
        sums = ("sum_q", "sum_dx", "sum_dz", "sum_t1x", "sum_t1y", "sum_t2x", "sum_t2y")
        for name, form in zip(sums, forms.values(), strict=True):
            assigns.append(Assign(name, form, f"const {REAL}"))
        return self._part(assigns)

    def velocities_from_sums(self, pressed: int) -> Part:
        """Velocities after the collision from the impulse sums; pressed 0: of either ball."""
        equal = {s.BETA1: 1, s.BETA2: 1}
        sums = {t: sp.Symbol(f"sum_{t.name.replace('_', '')}", real=True) for t in (s.D_X, s.D_Z)}
        sums[s.DQ] = sp.Symbol("sum_q", real=True)
        for ball in (1, 2):
            for axis, t in zip("xy", TABLE[ball], strict=True):
                name = f"sum_t{axis}" if pressed else f"sum_t{ball}{axis}"
                idle = pressed not in (0, ball)
                sums[t] = sp.Integer(0) if idle else sp.Symbol(name, real=True)
        changes = dict(velocity_changes())
        if self.terms.lift and pressed:
            changes.update(lift_changes(pressed))
        assigns = []
        for symbol, change in changes.items():
            change = sp.expand(change.subs(equal).subs(sums))
            if change != 0:
                member = sp.Symbol(f"b.{symbol.name}", real=True)
                assigns.append(Assign(member.name, member + change))
        return self._part(assigns, self.plain)

    def level_update(self) -> Part:
        """Slip and approach velocity after one step without pressing."""
        nothing = {t: 0 for ball in (1, 2) for t in TABLE[ball]} | {s.D_Z: 0}
        changes = reduced_system(self.terms, 2).changes
        kept = {s.C_X: changes[s.C_X].subs(nothing), **_approach_changes(())}
        assigns = [Assign(n.name, n + change) for n, change in kept.items()]
        return self._part([*assigns, APPROACH], self.plain)

    def lift_from_sums(self) -> Part:
        """Vertical velocity of the lifted ball: d_z > 0 lifts ball 1, d_z < 0 ball 2."""
        if not self.terms.lift:
            return Part((), OperationCounts())
        lines = (
            "b.v1z = b.v1z + (sum_dz > 0.0 ? sum_dz : 0.0);",
            "b.v2z = b.v2z - (sum_dz < 0.0 ? sum_dz : 0.0);",
        )
        return Part(lines, OperationCounts(add=2, select=2))

    # -- lanes that are balls ------------------------------------------------------------------

    def ball_lane_slips(self) -> Part:
        """Table slips of both balls at once, then the contact slip and the approach velocity."""
        lane = {f"{k}1{a}": sp.Symbol(f"{k}_{a}", real=True) for k in "vo" for a in "xyz"}
        item = {
            f"{k}{n}{a}": sp.Symbol(f"{k}_{a}[{n - 1}]", real=True)
            for k in "vo"
            for n in (1, 2)
            for a in "xyz"
        }
        forms = dict(slips(self.terms).items())
        in_lanes = {v: lane[v.name] for v in (*s.V1, *s.O1)}
        in_items = {v: item[v.name] for v in (*s.V1, *s.V2, *SPIN_SYMBOLS)}
        table = [
            Assign(f"s_{a}", forms[symbol].subs(in_lanes), "const Pair")
            for a, symbol in (("x", s.S1X), ("y", s.S1Y))
        ]
        contact = [
            Assign(symbol.name, forms[symbol].subs(in_items), f"const {REAL}")
            for symbol in (s.C_X, s.C_Z)
        ]
        pairs, singles = self._part(table, self.plain), self._part(contact, self.plain)
        return Part((*pairs.lines, *singles.lines), pairs.counts * 2 + singles.counts)

    def pair_constants(self, part: Part) -> dict[str, tuple[str, str]]:
        """The pairs {a, b} that the lines of a part name, by name."""
        found = sorted({name for line in part for name in re.findall(r"pair_\w+", line)})
        return {name: _pair_values(name) for name in found if name != "pair_"}

    def ball_lanes(self) -> Part:
        """The full state's update with lane 0 = ball 1, lane 1 = ball 2."""
        changes = {v: e.subs({s.BETA1: 1, s.BETA2: 1}) for v, e in velocity_changes().items()}
        assigns, alike = [], 0
        t_x, t_y = (sp.Symbol(f"t_{a}", real=True) for a in "xy")
        for kind, first, second in (("v", s.V1, s.V2), ("o", s.O1, s.O2)):
            for index, axis in enumerate("xyz" if kind == "o" else "xy"):
                one, two = (
                    sp.expand(changes[ball[index]]).subs(
                        dict(zip(TABLE[n], (t_x, t_y), strict=True))
                    )
                    for n, ball in ((1, first), (2, second))
                )
                target = sp.Symbol(f"{kind}_{axis}", real=True)
                assigns.append(Assign(target.name, target + _lane_form(one, two, (t_x, t_y))))
                alike += _alike(one, two)
        update = self._part(self._in_order(assigns), self.lanes)
        return Part(update.lines, update.counts * 2 + self._counted_twice(alike))

    def slip_lanes(self, pressed: int) -> Part:
        """The reduced update with lane 0 = contact slip, lane 1 = the pressed ball's slip."""
        changes = reduced_system(self.terms, pressed).changes
        x, y = SLIP_SYMBOLS[f"s{pressed}"]
        t_x, t_y = TABLE[pressed]
        assigns, alike = [], 0
        for name, lanes in (("x_lane", (s.C_X, x)), ("z_lane", (s.C_Z, y))):
            target = sp.Symbol(name, real=True)
            first, second = (changes[lane] for lane in lanes)
            assigns.append(Assign(name, target + _lane_form(first, second, (t_x, t_y))))
            alike += _alike(first, second)
        block = lower(assigns, self.lanes)
        approaches = _approach_changes((pressed,)).items()
        approach = lower([*(Assign(n.name, n + c) for n, c in approaches), APPROACH], self.plain)
        before, after = (block, approach) if self._chain_first else (approach, block)
        own = block.counts * 2 + self._counted_twice(alike)
        return Part((*before.lines, *after.lines), own + approach.counts)

    def _counted_twice(self, alike: int) -> OperationCounts:
        """To take off: products that both lanes share are made once, where no FMA holds them."""
        return OperationCounts(mul=0 if self.variant["fma"] == "fma" else -alike)

    def lane_counts(self, simd: str) -> OperationCounts:
        """Operations of what templates/fixed_step/*_lanes.j2 lay out around the update.

        An operation on a pair counts twice.
        """
        fused = self.variant["fma"] == "fma"
        square = OperationCounts(mul=1, fma=1) if fused else OperationCounts(mul=2, add=1)
        steps = int(self.variant["rsqrt"][-1]) if self.variant["rsqrt"].startswith("est") else 0
        newton = OperationCounts(mul=4, add=2) * steps
        root = newton + (OperationCounts(estimate=1) if steps else OperationCounts(div=1, sqrt=1))
        pair = (square + root) * 2
        if simd == "slips":  # two unit vectors, contact friction, table friction
            return pair + OperationCounts(mul=4 + 2 + 3)
        single = square + self._inverse_root("n", "c")[1]
        lift = OperationCounts(add=2 if self.terms.lift else 0)
        # contact friction, table friction of both balls, v_n
        return pair + single + lift + OperationCounts(mul=4 + 8, add=1)

    # ------------------------------------------------------------------------------------------

    def _part(self, assigns: list[Assign], printer: ExpressionPrinter | None = None) -> Part:
        block: Block = lower(assigns, printer or self.printer)
        return Part(tuple(block.lines), block.counts)


def _alike(first: sp.Expr, second: sp.Expr) -> int:
    """Products of impulses between the balls that are the same in both lanes."""
    forms = sp.expand(first), sp.expand(second)
    pairs = [[form.coeff(symbol) for form in forms] for symbol in (s.DQ, s.D_X, s.D_Z)]
    return sum(a == b and a not in (-1, 0, 1) for a, b in pairs)


def _lane_form(first: sp.Expr, second: sp.Expr, table: tuple[sp.Symbol, ...]) -> sp.Expr:
    """A linear form whose coefficients are pairs: `pair_<a>_<b>` names the constant {a, b}."""
    terms = []
    for symbol in (s.DQ, s.D_X, s.D_Z, *table):
        a, b = sp.expand(first).coeff(symbol), sp.expand(second).coeff(symbol)
        if a == 0 and b == 0:
            continue
        factor = a if a == b else pair_symbol(a, b)
        terms.append(factor * symbol)
    return sp.Add(*terms)


def _pair_values(name: str) -> tuple[str, str]:
    first, second = name.removeprefix("pair_").split("_")
    read = (sp.Rational(x.replace("m", "-").replace("o", "/")) for x in (first, second))
    one, two = (number(value) for value in read)
    return one, two


def pair_symbol(a: sp.Expr, b: sp.Expr) -> sp.Symbol:
    text = f"pair_{a}_{b}".replace("-", "m").replace("/", "o").replace(".", "p")
    return sp.Symbol(text, real=True)
