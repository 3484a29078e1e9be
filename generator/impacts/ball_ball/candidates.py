"""Which kernels of two balls are worth trying before any has been timed."""

from __future__ import annotations

from ...choice.candidates import Candidates
from ...steppers.budgets import tableaus_for
from .presets import BASELINE, PAPER_PRESETS, find_preset

# Our short list for fixed steps: the slips alone and one pressed ball, in the ways of making 1/|c|
# and of writing the loop that have won somewhere.
_BASE = {"state": "reduced", "reuse": "factored", "roots": "early", "branch": "chosen"}
_SHORT_LIST: tuple[dict[str, str], ...] = (
    *(
        {**_BASE, "rsqrt": rsqrt, "order": "chain", "loop": loop}
        for rsqrt in ("ahead", "prev", "est1", "est2", "inv")
        for loop in ("onestage", "twostage")
    ),
    {**_BASE, "rsqrt": "ahead", "loop": "twostage"},
    {**_BASE, "rsqrt": "ahead", "loop": "twostage", "order": "chain", "store": "blocks"},
    {**_BASE, "rsqrt": "ahead", "loop": "twostage", "order": "chain", "simd": "prepost"},
    {**_BASE, "rsqrt": "ahead", "loop": "twostage", "order": "chain", "reuse": "precompute"},
    {**_BASE, "rsqrt": "est1", "loop": "twostage", "reuse": "precompute", "simd": "slips"},
)

CANDIDATES = Candidates(
    published={preset.name: preset.options for preset in PAPER_PRESETS},
    baseline=BASELINE.name,
    fixed=_SHORT_LIST,
    fixed_default=find_preset("reduced-ahead").options,
    # Ways with finished lanes and vectors interleaved that have won somewhere.
    fixed_lanes=(("aside", "i3"), ("aside", "i2"), ("refilled", "i3")),
    tableaus_for=tableaus_for,
)
