"""The derivation of a contact model as formulas under titles, and what their symbols mean."""

from __future__ import annotations

from ..derivation import Chapter, chapter
from .contact import slips, velocity_changes
from .models import ContactModel
from .reduced import EQUAL_MASSES, recovery, reduced_system

LEGEND = (
    ("x, y, z", "right, forward (from ball 1 to ball 2) and up: r, f, u of the paper"),
    ("v1, v2", "velocities of the two centres, m/s"),
    ("o1, o2", "spins as speeds, R times the angular velocity, m/s"),
    ("c", "slip at the point where the balls touch, ball 1 less ball 2, m/s"),
    ("s1, s2", "slips of the two balls on the table, m/s"),
    ("v_n", "speed at which the balls part along y; below 0 they approach, m/s"),
    ("dq", "one increment of the normal impulse, divided by the mass, m/s"),
    ("d", "friction between the balls in that increment, on ball 1, divided by the mass, m/s"),
    ("t1, t2", "friction of the table in that increment, divided by the mass, m/s"),
    ("dX, sum X", "the change of X by one increment; X summed over the collision"),
    ("pressed", "the ball that friction between the balls presses onto the table"),
)


def derivation(model: ContactModel) -> tuple[Chapter, ...]:
    """Slips, velocity changes, then for each pressed ball the reduced system and its recovery."""
    terms = model.terms
    changes = [(symbol, change.subs(EQUAL_MASSES)) for symbol, change in velocity_changes().items()]
    chapters = [
        chapter("slips, as v + w x r at the contact and table points", "", slips(terms).items()),
        chapter("velocities, one increment dq of normal impulse", "d", changes),
    ]
    for ball in (2, 1):
        system, sums = reduced_system(terms, ball).changes, recovery(terms, ball).sums
        title = f"impulse sums from the changes of the slips, ball {ball} pressed"
        chapters += [
            chapter(f"reduced system with ball {ball} pressed", "d", system.items()),
            chapter(title, "sum ", sums.items()),
        ]
    return tuple(chapters)
