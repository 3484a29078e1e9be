"""The derivation as formulas under titles, and what their symbols mean."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from ..derivation import Chapter
from . import symbols as s
from .contact import slips, table_force, velocity_rates, work_rate
from .models import ContactModel
from .reduced import recovery, slip_rates, stuck_cushion, stuck_table, table_slip_y

LEGEND = (
    ("x, y, z", "along the cushion, into it, and up"),
    ("S, C", "sine and cosine of the angle of the nose above the centre; S = h/R - 1"),
    ("v, o", "velocity of the centre and spin as a speed, R times the angular velocity, m/s"),
    ("c", "slip at the nose, along x and up the cushion's face, m/s"),
    ("s", "slip on the table, m/s"),
    ("q", "normal impulse at the nose divided by the mass, m/s; X' is the rate of X per q"),
    ("d", "friction of the cushion for a unit of q: -u_w c/|c|"),
    ("N, t", "force of the table for a unit of q, and its friction: -u_s N s/|s|"),
    ("ec, es", "unit vectors along c and s"),
    ("W", "work of the normal impulse at the nose, divided by the mass, m^2/s^2"),
    ("dX", "the change of X over the collision"),
)


def derivation(model: ContactModel) -> tuple[Chapter, ...]:
    """Slips, rates, friction where a contact sticks, then velocities from the slips' changes."""
    force = sp.Function("max")(0, table_force()) if model.terms.clamped else table_force()
    chapters = [
        _chapter("slips, as v + w x r at the nose and the lowest point", "", slips().items()),
        _chapter("rates of the velocities per q", "'", velocity_rates().items()),
        _chapter("work and the table's force", "", ((s.WORK, work_rate()), (s.N, force))),
        _chapter("the reduced loop", "'", slip_rates().items()),
        _chapter("the slip on the table, in every state", "", ((s.S_Y, table_slip_y()),)),
    ]
    if model.terms.sticks:
        stuck = stuck_cushion()
        at_nose = (*stuck.friction.items(), (s.N, stuck.force))
        chapters += [
            _chapter("friction where the nose sticks", "", at_nose),
            _chapter("friction where the table sticks", "", stuck_table().items()),
        ]
    return (*chapters, _chapter("changes of the velocities", "d", recovery().items(), "d"))


def _chapter(
    title: str, mark: str, formulas: Iterable[tuple[sp.Symbol, sp.Expr]], before: str = ""
) -> Chapter:
    after = "" if before else mark
    return Chapter(title, tuple((f"{before}{sym}{after}", str(form)) for sym, form in formulas))
