"""What contact models and masses may be. It is read without SymPy, which takes a second to load."""

from __future__ import annotations

from dataclasses import dataclass

MASS_RATIOS = (0.1, 10.0)  # of ball 1 to ball 2, that may be


@dataclass(frozen=True)
class ContactTerms:
    """The two independent terms in which the contact models differ."""

    table_slip_point: str  # "bottom" (Mathavan 2014) or "top" (pooltool, the report)
    lift: bool  # does the lifted ball's vertical velocity enter the contact slip?

    def __post_init__(self) -> None:
        if self.table_slip_point not in ("top", "bottom"):
            raise ValueError(f"table slip point must be top or bottom, not {self.table_slip_point}")
