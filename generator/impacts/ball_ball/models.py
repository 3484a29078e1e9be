"""The contact models users ask for: presets of the two terms in which they differ."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import named
from .terms import ContactTerms


@dataclass(frozen=True)
class ContactModel:
    """A named preset of contact terms."""

    name: str
    terms: ContactTerms
    text: str


MODELS: tuple[ContactModel, ...] = (
    ContactModel(
        "mathavan2014",
        ContactTerms("bottom", lift=True),
        "the paper as printed: slip at the ball's lowest point, the lifted ball's v_z counts",
    ),
    ContactModel(
        "bottom_slip",
        ContactTerms("bottom", lift=False),
        "pooltool with the sign of its table slip put right",
    ),
    ContactModel(
        "pooltool",
        ContactTerms("top", lift=False),
        "pooltool 0.6 and the report to the digit: table slip at the ball's highest point",
    ),
)

DEFAULT_MODEL = MODELS[0].name


def find_model(name: str) -> ContactModel:
    """A model by its name. Raises InputError naming the models there are."""
    return named("model", name, {model.name: model for model in MODELS})
