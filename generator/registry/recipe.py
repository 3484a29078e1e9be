"""A recipe: one way to answer a question.

    RECIPE := STEPPER ( " " AXIS "=" CODE )*

STEPPER is `fixed` or a tableau. Axes stand in the order of the registry; those at their default are
left out, so that a new axis changes no recipe there is. `lane_root` is written always: without it,
lanes take the root of single calls.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..tableaus.tableaus import TABLEAUS
from .axes import axis
from .question import Family

FIXED = "fixed"  # the stepper of fixed steps
SERIES = "series"  # that of power series; all others are tableaus
HIDDEN = ("compiler", "flags")  # what only the compiler sees
_EXPLICIT = "lane_root"


@dataclass(frozen=True)
class Recipe:
    """A stepper and its options: a choice for each axis that it has, in axis order."""

    stepper: str
    options: tuple[tuple[str, str], ...]

    @property
    def family(self) -> Family:
        return family_of(self.stepper)

    def __str__(self) -> str:
        return self.text()

    def text(self, without: tuple[str, ...] = ()) -> str:
        """The recipe as it is written, without some axes."""
        words = [
            f"{key}={code}"
            for key, code in self.options
            if key not in without and (key == _EXPLICIT or code != axis(key).default)
        ]
        return " ".join((self.stepper, *words))


def family_of(stepper: str) -> Family:
    return "fixed" if stepper == FIXED else "exact"


def read_recipe(text: str) -> tuple[str, dict[str, str]]:
    """A stepper and what is written of its options. Raises ValueError where a word is wrong."""
    stepper, *words = text.split() or [""]
    steppers = (FIXED, SERIES, *TABLEAUS)
    if stepper not in steppers:
        raise ValueError(f"'{stepper}' is no stepper; there are {', '.join(steppers)}")
    options: dict[str, str] = {}
    for word in words:
        key, is_pair, code = word.partition("=")
        if not is_pair or key in options:
            raise ValueError(f"'{word}' in '{text}': expected AXIS=CODE, each axis once")
        options[key] = code
    return stepper, options
