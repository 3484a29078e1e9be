"""Two balls that collide on a table, as a row of the registry of impacts."""

from __future__ import annotations

from ..impact import Body, Functions, Impact, Result, Sensitivity, Status, Words
from . import scene, words
from .columns import COLUMNS
from .models import DEFAULT_MODEL, MODELS, find_model
from .parameters import PARAMETERS

_STATUSES = (
    Status("OK", 0, "collided"),
    Status("SEPARATING", 1, "not approaching: velocities as they came"),
    Status("BAD_INPUT", 2, "not finite, coincident, or outside the scene: as they came"),
    Status("TILTED", 3, "rises by more than 1e-6 of its length: as they came"),
)


def _words() -> Words:
    return words


def _sensitivity(model: str) -> Sensitivity:
    """The most that the oracle finds, whatever kernel there is.

    Where the table drives its slip away from zero, a slip that just passes zero grows for long
    after; roots and rounding err most in the same rare passages, where the steps' own error is
    small.
    """
    from .reduced import drives_its_slip

    driven = drives_its_slip(find_model(model).terms)
    return Sensitivity(148.0, adds_up=True) if driven else Sensitivity(2.4, adds_up=False)


BALL_BALL = Impact(
    name="ball-ball",
    package=__name__.rpartition(".")[0],
    text="two balls of one radius on a table",
    parameters=PARAMETERS,
    columns=COLUMNS,
    functions=Functions(
        prefix="",
        bodies=(Body("ball1", 9), Body("ball2", 9)),
        results=(Result("out1", "ball1", 9, 3, 6), Result("out2", "ball2", 9, 3, 6)),
        varied="u_b",
    ),
    statuses=_STATUSES,
    ends="the normal impulse has done e_b^2 of the work of compression in restitution",
    relative_to="the relative speed |v1 - v2|",
    default_model=DEFAULT_MODEL,
    has_kernels=True,
    model_table=lambda: MODELS,
    scene_table=lambda: scene.scenes(),  # asked anew: the one table, whoever has added to it
    words=_words,
    sensitivity=_sensitivity,
)
