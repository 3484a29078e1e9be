"""The contact models users ask for: presets of the two terms in which they differ."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import named
from .terms import ContactTerms


@dataclass(frozen=True)
class ContactModel:
    """A named preset of contact terms.

    `most`: the largest u_b and u_s that an error budget is promised for, and searched up to.
    Beyond, friction on the table all but balances what drives the slip, or (`pooltool`) drives it
    on without bound.
    """

    name: str
    terms: ContactTerms
    text: str
    most: tuple[tuple[str, float], ...]


MODELS: tuple[ContactModel, ...] = (
    ContactModel(
        "mathavan2014",
        ContactTerms("bottom", lift=True),
        "the paper as printed: slip at the ball's lowest point, the lifted ball's v_z counts",
        most=(("u_b", 0.6), ("u_s", 1.0)),
    ),
    ContactModel(
        "bottom_slip",
        ContactTerms("bottom", lift=False),
        "pooltool with the sign of its table slip put right",
        most=(("u_b", 0.6), ("u_s", 1.0)),
    ),
    ContactModel(
        "pooltool",
        ContactTerms("top", lift=False),
        "pooltool 0.6 and the report to the digit: table slip at the ball's highest point",
        most=(("u_b", 0.3), ("u_s", 0.5)),
    ),
)

DEFAULT_MODEL = MODELS[0].name


def find_model(name: str) -> ContactModel:
    """A model by its name. Raises InputError naming the models there are."""
    return named("model", name, {model.name: model for model in MODELS})
