"""What contact models may be. It is read without SymPy, which takes a second to load."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ContactTerms:
    """The two independent terms in which the contact models differ."""

    clamped: bool  # does the table only push, N = max(0, .), or may it pull?
    sticks: bool  # is friction of no slip what Coulomb admits, or what atan2(0, 0) gives?
