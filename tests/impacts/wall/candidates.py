from __future__ import annotations

from generator.choice.candidates import Candidates

CANDIDATES = Candidates(
    published={"plain": {}},
    baseline="plain",
    fixed=(),
    fixed_default={},
    fixed_lanes=(),
    tableaus_for=lambda budget: ("dp54",),
)
