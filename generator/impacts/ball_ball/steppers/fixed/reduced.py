"""The reduced loop of the fixed-step scheme: slips after a step, velocities from impulse sums."""

from __future__ import annotations

import sympy as sp

from .....lowering.statements import Assign, Part
from ... import symbols as s
from ...contact import lift_changes, velocity_changes
from ...reduced import (
    DELTAS,
    DELTAS_BOTH,
    merge_pressed,
    recovery,
    recovery_both,
    reduced_system,
)
from .parts import (
    APPROACH,
    REAL,
    SLIP_SYMBOLS,
    TABLE,
    U_TABLE,
    FixedStepLowering,
    K,
    approach_changes,
)


def update_pressed(low: FixedStepLowering, pressed: int) -> Part:
    """Slips after one step with one pressed ball, as derived (coefficients from SymPy)."""
    changes = _pressed_changes(low, pressed)
    assigns = [Assign(n.name, n + change) for n, change in changes.items()]
    return low.part([*assigns, APPROACH])


_H_X, _H_Z, _G, _G_X, _G_Y, _I_C, _I_CS = sp.symbols("h_x h_z g g_x g_y i_c i_cs", real=True)


def factored_impulses(low: FixedStepLowering, pressed: int) -> Part:
    """Impulses before inverse lengths are multiplied in: h of contact, g of the table."""
    x, y = SLIP_SYMBOLS[f"s{pressed}"]
    push = (-1 if pressed == 2 else 1) * U_TABLE[pressed]
    forms = {
        "h_x": -K * s.C_X,
        "h_z": -K * s.C_Z,
        "g": push * _H_Z,
        "g_x": _G * x,
        "g_y": _G * y,
        "i_cs": _I_C * sp.Symbol(f"i_s{pressed}", real=True),
    }
    return low.part([Assign(name, form, f"const {REAL}") for name, form in forms.items()])


def update_factored(low: FixedStepLowering, pressed: int) -> Part:
    """As update_pressed, the inverse lengths multiplied in last: the critical chain is short.

    n' = n + fixed + i_c * (contact part) + i_c i_s * (table part), where neither part needs an
    inverse length.
    """
    changes = _pressed_changes(low, pressed)
    t_x, t_y = TABLE[pressed]
    assigns = []
    for name, change in changes.items():
        value = name + change.coeff(s.DQ) * s.DQ
        contact = sp.expand(change.coeff(s.D_X) * _H_X + change.coeff(s.D_Z) * _H_Z)
        table = sp.expand(change.coeff(t_x) * _G_X + change.coeff(t_y) * _G_Y)
        for factor, form in ((_I_C, contact), (_I_CS, table)):
            if form != 0:
                assigns.append(Assign(name.name, value + factor * form))
                value = name
        if value != name:
            assigns.append(Assign(name.name, value))
    return low.part([*assigns, APPROACH])


def _pressed_changes(low: FixedStepLowering, pressed: int) -> dict[sp.Symbol, sp.Expr]:
    changes = reduced_system(low.terms, pressed).changes
    slip = SLIP_SYMBOLS[f"s{pressed}"]
    approach = approach_changes((pressed,))
    contact = {n: changes[n] for n in (s.C_X, s.C_Z)}
    table = {n: changes[n] for n in slip}
    if low.chain_first:
        return {**contact, **table, **approach}
    return {**approach, **table, **contact}


def update_both(low: FixedStepLowering) -> Part:
    """Slips after one step, table friction of both balls given (one of them zero)."""
    one, two = (reduced_system(low.terms, p).changes for p in (1, 2))
    merged = {n: merge_pressed(one[n], two[n]) for n in one if n != s.V_N}
    approach = approach_changes((1, 2))
    merged = {**merged, **approach} if low.chain_first else {**approach, **merged}
    assigns = [Assign(n.name, n + change) for n, change in merged.items()]
    return low.part([*assigns, APPROACH])


def recover_pressed(low: FixedStepLowering, pressed: int) -> Part:
    """Impulse sums from the changes of the slips: SymPy's solution of the linear system."""
    forms = recovery(low.terms, pressed).sums
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
    return low.part(assigns)


def recover_both(low: FixedStepLowering) -> Part:
    """As recover_pressed, where either ball may have been pressed in turn."""
    forms = recovery_both(low.terms)
    now = (s.C_X, s.C_Z, s.S1X, s.S1Y, s.S2X, s.S2Y, s.V_N)
    assigns = [
        Assign(delta.name, name - sp.Symbol(f"{name.name}_0", real=True), f"const {REAL}")
        for delta, name in zip(DELTAS_BOTH, now, strict=True)
    ]
    sums = ("sum_q", "sum_dx", "sum_dz", "sum_t1x", "sum_t1y", "sum_t2x", "sum_t2y")
    for name, form in zip(sums, forms.values(), strict=True):
        assigns.append(Assign(name, form, f"const {REAL}"))
    return low.part(assigns)


def velocities_from_sums(low: FixedStepLowering, pressed: int) -> Part:
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
    if low.terms.lift and pressed:
        changes.update(lift_changes(pressed))
    assigns = []
    for symbol, change in changes.items():
        change = sp.expand(change.subs(equal).subs(sums))
        if change != 0:
            member = sp.Symbol(f"b.{symbol.name}", real=True)
            assigns.append(Assign(member.name, member + change))
    return low.part(assigns, low.plain)


def update_level(low: FixedStepLowering) -> Part:
    """Slip and approach velocity after one step without pressing."""
    nothing = {t: 0 for ball in (1, 2) for t in TABLE[ball]} | {s.D_Z: 0}
    changes = reduced_system(low.terms, 2).changes
    kept = {s.C_X: changes[s.C_X].subs(nothing), **approach_changes(())}
    assigns = [Assign(n.name, n + change) for n, change in kept.items()]
    return low.part([*assigns, APPROACH], low.plain)
