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
        "clamped",
        ContactTerms(clamped=True, sticks=True),
        "Coulomb friction at both contacts, a table that only pushes",
    ),
    ContactModel(
        "printed",
        ContactTerms(clamped=False, sticks=True),
        "the paper as printed: Coulomb friction, a table that pulls where friction lifts the ball",
    ),
    ContactModel(
        "pooltool",
        ContactTerms(clamped=False, sticks=False),
        "pooltool 0.6 to the digit: as printed, and without slip full friction along -x",
    ),
)

DEFAULT_MODEL = MODELS[0].name


def find_model(name: str) -> ContactModel:
    """A model by its name. Raises InputError naming the models there are."""
    return named("model", name, {model.name: model for model in MODELS})
