"""The derivation of the cushion against rates written by hand, from the paper."""

from __future__ import annotations

import pytest
import sympy as sp

from generator.errors import InputError
from generator.impacts.ball_cushion import symbols as s
from generator.impacts.ball_cushion.contact import (
    reduce_angle,
    slips,
    table_force,
    velocity_rates,
    work_rate,
)
from generator.impacts.ball_cushion.derivation import derivation
from generator.impacts.ball_cushion.models import MODELS, find_model
from generator.impacts.ball_cushion.reduced import (
    D_SLIPS,
    recovery,
    rolling_spin,
    slip_rates,
    stuck_cushion,
    stuck_table,
    table_slip_y,
)
from generator.impacts.ball_cushion.scene import parse_scene, scenes

HALF = sp.Rational(1, 2)
M = 1 - 5 * HALF * s.SIN
G = 5 * HALF - s.SIN
A = 5 * HALF + s.SIN**2


def differences(got, want) -> list[sp.Expr]:
    return [reduce_angle(got[name] - form) for name, form in want.items()]


def test_slips_by_hand() -> None:
    want = {
        s.C_X: s.V_X + s.SIN * s.O_Y - s.COS * s.O_Z,
        s.C_Z: -s.SIN * s.V_Y + s.O_X,
        s.S_X: s.V_X - s.O_Y,
        s.S_Y: s.V_Y + s.O_X,
    }
    assert not any(differences(slips(), want))


def test_velocity_rates_by_hand() -> None:
    want = {
        s.V_X: s.D_X + s.T_X,
        s.V_Y: -s.COS - s.SIN * s.D_Z + s.T_Y,
        s.O_X: 5 * HALF * (s.D_Z + s.T_Y),
        s.O_Y: 5 * HALF * (s.SIN * s.D_X - s.T_X),
        s.O_Z: -5 * HALF * s.COS * s.D_X,
    }
    assert not any(differences(velocity_rates(), want))
    assert table_force() == s.SIN - s.COS * s.D_Z
    assert work_rate() == s.COS * s.V_Y


def test_the_reduced_loop_by_hand() -> None:
    want = {
        s.C_X: 7 * HALF * s.D_X + M * s.T_X,
        s.C_Z: s.SIN * s.COS + A * s.D_Z + G * s.T_Y,
        s.S_X: M * s.D_X + 7 * HALF * s.T_X,
        s.S_Y: -s.COS + G * s.D_Z + 7 * HALF * s.T_Y,
    }
    assert not any(differences(slip_rates(), want))
    assert sp.expand(table_slip_y() - s.C_Z - (1 + s.SIN) * s.V_Y) == 0
    assert sp.expand(rolling_spin() - s.C_Z - s.SIN * s.V_Y) == 0


def test_friction_of_a_stuck_cushion_by_hand() -> None:
    stuck = stuck_cushion()
    bottom = A + G * s.U_S * s.COS * s.ES_Y
    force = 7 * HALF * s.SIN / bottom
    d_z = -(s.SIN * s.COS - G * s.U_S * s.SIN * s.ES_Y) / bottom
    d_x = sp.Rational(2, 7) * M * s.U_S * force * s.ES_X
    for got, want in ((stuck.force, force), *zip(stuck.friction.values(), (d_x, d_z), strict=True)):
        top = sp.fraction(sp.together(got - want))[0]
        assert reduce_angle(top) == 0
    friction = {**stuck.friction, s.T_X: -s.U_S * stuck.force * s.ES_X}
    friction[s.T_Y] = -s.U_S * stuck.force * s.ES_Y
    for name in (s.C_X, s.C_Z):
        assert reduce_angle(sp.fraction(sp.together(slip_rates()[name].subs(friction)))[0]) == 0


def test_friction_of_a_stuck_table_by_hand() -> None:
    push = {s.T_X: M * s.D_X, s.T_Y: -s.COS + G * s.D_Z}
    want = {name: -sp.Rational(2, 7) * form for name, form in push.items()}
    assert not any(differences(stuck_table(), want))


def test_velocities_come_back_from_the_changes_of_the_slips() -> None:
    rates = slip_rates()
    values = (rates[s.C_X], rates[s.C_Z], rates[s.S_X], velocity_rates()[s.V_Y])
    given = dict(zip(D_SLIPS, values, strict=True))
    for velocity, change in recovery().items():
        rest = sp.together(change.subs(given) - velocity_rates()[velocity])
        assert reduce_angle(sp.fraction(rest)[0]) == 0, velocity


def test_an_invariant_holds_whatever_friction_does() -> None:
    """R w_y + 5/2 v_x + (1 + S)/C R w_z stays."""
    rates = velocity_rates()
    change = s.COS * (rates[s.O_Y] + 5 * HALF * rates[s.V_X]) + (1 + s.SIN) * rates[s.O_Z]
    assert reduce_angle(change) == 0


@pytest.mark.parametrize("name", [model.name for model in MODELS])
def test_every_model_explains_itself(name: str) -> None:
    chapters = derivation(find_model(name))
    print("\n".join(f"{sym} = {form}" for c in chapters for sym, form in c.formulas))
    assert sum("sticks" in chapter.title for chapter in chapters) == (
        0 if name == "pooltool" else 2
    )


def test_shipped_scenes_say_where_the_nose_is() -> None:
    assert list(scenes()) == ["any", "carom", "pool", "snooker"]
    assert {n: len(scene.free) for n, scene in scenes().items()} == {
        "any": 6,
        "carom": 3,
        "pool": 1,
        "snooker": 1,
    }


@pytest.mark.parametrize(
    ("fixed", "says"),
    [
        ("R = 0.03\nh = 0.02", "fixed.h: 0.02 with R 0.03; expected R to below 2 R"),
        ("R = 0.03\nh = 0.06", "expected R to below 2 R"),
        ("R = 0.03\nh = 0.055\nu_s = 0.5\nu_w = 0.6", "degrees; expected below 90"),
        ("u_b = 0.5", "no such parameter; there are R, M, u_s, u_w, e_c, h"),
    ],
)
def test_a_scene_that_cannot_be_is_refused_in_a_line(fixed: str, says: str) -> None:
    with pytest.raises(InputError) as error:
        parse_scene(f'name = "odd"\ntext = "odd"\n[fixed]\n{fixed}\n', "odd.toml")
    assert says in str(error.value)
