"""The derivation of an impact as formulas under titles: its module `derivation`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol

from .impact import Impact


@dataclass(frozen=True)
class Chapter:
    """Formulas under a title: symbols, and what each is."""

    title: str
    formulas: tuple[tuple[str, str], ...]


def chapter(title: str, mark: str, formulas: Iterable[tuple[object, object]]) -> Chapter:
    """A chapter of symbols and their forms; `mark` stands before each symbol."""
    return Chapter(title, tuple((f"{mark}{symbol}", str(form)) for symbol, form in formulas))


class Derivation(Protocol):
    LEGEND: tuple[tuple[str, str], ...]  # symbols and their meanings

    def derivation(self, model: Any) -> tuple[Chapter, ...]: ...


def derivation_of(impact: Impact) -> Derivation:
    derived: Derivation = impact.part("derivation")
    return derived
