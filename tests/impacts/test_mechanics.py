"""The derived equations against those written by hand, from the paper and the reduced system."""

from __future__ import annotations

import pytest
import sympy as sp

from generator.impacts.ball_ball import symbols as s
from generator.impacts.ball_ball.contact import lift_changes, slips, velocity_changes
from generator.impacts.ball_ball.models import MODELS, find_model
from generator.impacts.ball_ball.reduced import DELTAS, recovery, recovery_both, reduced_system
from generator.impacts.ball_ball.terms import ContactTerms
from generator.lowering.printer import Divide, ExpressionPrinter, number
from generator.lowering.statements import Assign, lower

HALF = sp.Rational(1, 2)
EQUAL = {s.BETA1: 1, s.BETA2: 1}
MODEL_NAMES = [model.name for model in MODELS]


def terms_of(name: str) -> ContactTerms:
    return find_model(name).terms


def by_hand(name: str, pressed: int) -> dict[sp.Symbol, sp.Expr]:
    """The reduced system as the project's notes print it, phi being friction of the table."""
    sigma = 1 if pressed == 2 else -1
    phi_x, phi_y = (s.T2X, s.T2Y) if pressed == 2 else (s.T1X, s.T1Y)
    s_x, s_y = (s.S2X, s.S2Y) if pressed == 2 else (s.S1X, s.S1Y)
    lift, bottom = terms_of(name).lift, terms_of(name).table_slip_point == "bottom"
    point, table = (5 * HALF, 7 * HALF) if bottom else (-5 * HALF, -3 * HALF)
    return {
        s.C_X: 7 * s.D_X - sigma * phi_x,
        s.C_Z: (6 if lift else 5) * s.D_Z + 5 * HALF * phi_y,
        s_x: -sigma * s.D_X + table * phi_x,
        s_y: sigma * s.DQ + point * s.D_Z + table * phi_y,
        s.V_N: 2 * s.DQ + sigma * phi_y,
    }


def test_slips_by_hand() -> None:
    """v + w x r at the points of contact, spins as speeds."""
    for name in MODEL_NAMES:
        terms = terms_of(name)
        got = dict(slips(terms).items())
        sign = 1 if terms.table_slip_point == "top" else -1
        lifted = s.V1[2] - s.V2[2] if terms.lift else 0
        want = {
            s.C_X: s.V1[0] - s.V2[0] - s.O1[2] - s.O2[2],
            s.C_Z: s.O1[0] + s.O2[0] + lifted,
            s.S1X: s.V1[0] + sign * s.O1[1],
            s.S1Y: s.V1[1] - sign * s.O1[0],
            s.S2X: s.V2[0] + sign * s.O2[1],
            s.S2Y: s.V2[1] - sign * s.O2[0],
            s.V_N: s.V2[1] - s.V1[1],
        }
        assert {k: sp.expand(got[k] - want[k]) for k in want} == dict.fromkeys(want, 0)


def test_velocity_changes_by_hand() -> None:
    """dv = ((dP1 + dPx)/M, (-dP + dPy)/M), dw = C (dP2 + dPy, -dPx, -dP1); R C M = 5/2."""
    got = {v: sp.expand(change.subs(EQUAL)) for v, change in velocity_changes().items()}
    want = {
        s.V1[0]: s.D_X + s.T1X,
        s.V1[1]: -s.DQ + s.T1Y,
        s.V2[0]: -s.D_X + s.T2X,
        s.V2[1]: s.DQ + s.T2Y,
    }
    for spin, t_x, t_y in ((s.O1, s.T1X, s.T1Y), (s.O2, s.T2X, s.T2Y)):
        want[spin[0]] = 5 * HALF * (s.D_Z + t_y)
        want[spin[1]] = -5 * HALF * t_x
        want[spin[2]] = -5 * HALF * s.D_X
    assert {k: sp.expand(got[k] - want[k]) for k in want} == dict.fromkeys(want, 0)
    assert set(got) == set(want)


@pytest.mark.parametrize("pressed", [1, 2])
@pytest.mark.parametrize("name", MODEL_NAMES)
def test_reduced_system_by_hand(name: str, pressed: int) -> None:
    got = reduced_system(terms_of(name), pressed).changes
    for symbol, want in by_hand(name, pressed).items():
        assert sp.expand(got[symbol] - want) == 0, symbol


@pytest.mark.parametrize("pressed", [1, 2])
@pytest.mark.parametrize("name", MODEL_NAMES)
def test_recovery_solves_the_system_written_by_hand(name: str, pressed: int) -> None:
    """Impulse sums, put through the equations by hand, give back the changes of the slips."""
    found = recovery(terms_of(name), pressed)
    for delta, form in zip(DELTAS, by_hand(name, pressed).values(), strict=True):
        assert sp.expand(form.subs(found.sums) - delta) == 0, delta
    assert all(
        c.is_Rational for form in found.sums.values() for c in sp.Poly(form, *DELTAS).coeffs()
    )


def test_recovery_known_coefficients() -> None:
    """A few numbers solved on paper: bottom slip without lift, ball 2 pressed."""
    found = recovery(terms_of("bottom_slip"), 2)
    dc_x, _, ds_x, _, _ = DELTAS
    # 7 d - t = dc_x, -d + 7/2 t = ds_x: the determinant is 47/2.
    assert sp.expand(found.sums[s.D_X] - (7 * dc_x + 2 * ds_x) / 47) == 0
    assert sp.expand(found.sums[s.T2X] - (2 * dc_x + 14 * ds_x) / 47) == 0


@pytest.mark.parametrize("name", MODEL_NAMES)
def test_recovery_of_both_balls_agrees_with_one(name: str) -> None:
    both = recovery_both(terms_of(name))
    for pressed in (1, 2):
        changes = reduced_system(terms_of(name), pressed).changes
        names = ("dc_x", "dc_z", "ds1x", "ds1y", "ds2x", "ds2y", "dv_n")
        slip = (s.C_X, s.C_Z, s.S1X, s.S1Y, s.S2X, s.S2Y, s.V_N)
        put = {sp.Symbol(n, real=True): changes[x] for n, x in zip(names, slip, strict=True)}
        idle = (s.T1X, s.T1Y) if pressed == 2 else (s.T2X, s.T2Y)
        for impulse, form in both.items():
            want = 0 if impulse in idle else impulse
            assert sp.expand(form.subs(put) - want) == 0, (pressed, impulse)


def test_lift_goes_to_the_ball_that_is_not_pressed() -> None:
    assert lift_changes(2) == {s.V1[2]: s.BETA1 * s.D_Z, s.V2[2]: 0}
    assert lift_changes(1) == {s.V1[2]: 0, s.V2[2]: -s.BETA2 * s.D_Z}


def test_slip_point_and_lift_are_independent() -> None:
    systems = {
        (point, lift): reduced_system(ContactTerms(point, lift), 2).changes
        for point in ("top", "bottom")
        for lift in (False, True)
    }
    for point in ("top", "bottom"):
        difference = sp.expand(systems[point, True][s.C_Z] - systems[point, False][s.C_Z])
        assert difference == s.D_Z
    for lift in (False, True):
        assert systems["top", lift][s.C_Z] == systems["bottom", lift][s.C_Z]
        assert systems["top", lift][s.S2X] != systems["bottom", lift][s.S2X]
    with pytest.raises(ValueError, match="top or bottom"):
        ContactTerms("side", lift=False)


# ---- the printer -----------------------------------------------------------------------------

A, B, C, D = sp.symbols("a b c d", real=True)


def test_numbers_read_back_to_the_same_double() -> None:
    for value in (sp.Rational(2, 3), sp.Rational(7, 47), sp.pi.evalf(40), sp.Integer(7)):
        text = number(value)
        assert float(text) == float(value) and ("." in text or "e" in text)
    with pytest.raises(TypeError, match="no number"):
        number(A)


def test_fma_is_placed_only_where_it_is_asked_for() -> None:
    expression = A * B + C * D + A
    plain, plain_counts = ExpressionPrinter(False).print_counted(expression)
    fused, fused_counts = ExpressionPrinter(True).print_counted(expression)
    assert plain == "a + a * b + c * d"
    assert fused == "std::fma(c, d, std::fma(a, b, a))"
    assert (plain_counts.add, plain_counts.mul, plain_counts.fma) == (2, 2, 0)
    assert (fused_counts.add, fused_counts.mul, fused_counts.fma) == (0, 0, 2)
    assert plain_counts.flops == fused_counts.flops == 4


def test_order_does_not_depend_on_how_a_sum_was_made() -> None:
    printer = ExpressionPrinter(False)
    assert printer.print(A + B - C) == printer.print(-C + B + A) == "a + b - c"
    assert printer.print(A - B * C) == "a - b * c"
    assert printer.print(-A * B) == "-a * b"


def test_divisions_powers_and_brackets() -> None:
    printer = ExpressionPrinter(False)
    assert printer.print(A * (B + C)) == "a * (b + c)"
    assert printer.print(A**2) == "a * a"
    assert printer.print(Divide(A + B, C * D)) == "(a + b) / (c * d)"
    with pytest.raises(TypeError, match="does not know"):
        printer.print(sp.sin(A))
    with pytest.raises(TypeError, match="whole powers"):
        printer.print(sp.sqrt(A))


def test_printed_text_computes_the_expression() -> None:
    """Python's arithmetic is C++'s here: the text is evaluated and compared."""
    values = {A: 1.25, B: -0.5, C: 3.0, D: 0.75}
    forms = [A * B - C * D + 2, (A + B) * (C - D) / 3, -A * (B + C), A - B - C, 5 * A * B / (C * D)]
    for form in forms:
        text = ExpressionPrinter(False).print(form)
        got = eval(text, {str(k): v for k, v in values.items()})
        assert got == pytest.approx(float(form.subs(values)), rel=1e-14), text


def test_statements_are_in_the_order_given() -> None:
    block = lower(
        [Assign("t", A + B, "const double"), Assign("a", A * C)],
        ExpressionPrinter(False, {"a": "v[0]"}),
    )
    assert block.lines == ["const double t = b + v[0];", "v[0] = c * v[0];"] or block.lines == [
        "const double t = v[0] + b;",
        "v[0] = v[0] * c;",
    ]
    assert (block.counts.add, block.counts.mul) == (1, 1)
