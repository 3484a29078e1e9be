"""A ball that runs into a cushion, as a row of the registry of impacts."""

from __future__ import annotations

from ..impact import Body, Functions, Impact, Result, Sensitivity, Status, Words
from . import scene, words
from .columns import COLUMNS
from .models import DEFAULT_MODEL, MODELS
from .parameters import PARAMETERS

_STATUSES = (
    Status("OK", 0, "collided"),
    Status("SEPARATING", 1, "not moving into the cushion: velocities as they came"),
    Status("BAD_INPUT", 2, "not finite, no normal, jamming, or outside the scene: as they came"),
)


def _words() -> Words:
    return words


def _sensitivity(_model: str) -> Sensitivity:
    """What the oracle finds over the search's charts is at most 17, next to the jam at 85 degrees.

    `pytest -s tests/impacts/ball_cushion/test_sensitivity.py` measures it.
    """
    return Sensitivity(20.0, adds_up=True)


BALL_CUSHION = Impact(
    name="ball-cushion",
    package=__name__.rpartition(".")[0],
    text="a ball that rolls or slides on a table into a cushion",
    parameters=PARAMETERS,
    columns=COLUMNS,
    functions=Functions(
        prefix="cushion_",
        bodies=(Body("ball", 6), Body("normal", 2)),
        results=(Result("out", "ball", 6, 0, 6),),
        varied="u_w",
    ),
    statuses=_STATUSES,
    ends="the normal impulse has done e_c^2 of the work of compression in restitution",
    relative_to="the ball's speed |v|",
    default_model=DEFAULT_MODEL,
    has_kernels=True,
    model_table=lambda: MODELS,
    scene_table=lambda: scene.scenes(),  # asked anew: the one table, whoever has added to it
    words=_words,
    sensitivity=_sensitivity,
    axes=frozenset({"fma", "compiler", "flags"}),
    has_series=True,
)
