"""Named presets: every row of the report as a variant of ours, and our own best-known ones.

Rows of Li, Egger, Ruff, Pfingsten, "Optimizing ball to ball collisions on Zen 3 architecture", with
the mean cycles that the report gives for its five cases at N = 1000 on a Ryzen 7 7735U.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ...errors import InputError


@dataclass(frozen=True)
class Preset:
    """Options of a named variant; what is not named is the default."""

    name: str
    text: str
    options: dict[str, str] = field(hash=False)
    report_cycles: int | None = None


PAPER = "Optimizing ball to ball collisions on Zen 3 architecture"

_PAPER = {"compiler": "gcc", "flags": "report", "fma": "autofma"}
_NO_FMA = {**_PAPER, "fma": "nofma"}
_MASKS = {"branch": "bitmask", "roots": "early", "reuse": "precompute", "fma": "fma"}
_BEST = {
    "reuse": "precompute",
    "rsqrt": "est1",
    "roots": "early",
    "fma": "fma",
    "branch": "inverted",
}

PAPER_PRESETS: tuple[Preset, ...] = (
    Preset("paper-initial", "initial C with the report's flags", _PAPER, 46175),
    Preset(
        "paper-precompute",
        "branch hints and precomputation",
        {**_PAPER, "branch": "likely", "reuse": "precompute"},
        46787,
    ),
    Preset("paper-fma", "FMA", {**_PAPER, "reuse": "precompute", "fma": "fma"}, 51066),
    Preset("paper-masks", "bitmasks, FMA and rsqrt", {**_PAPER, **_MASKS, "rsqrt": "est1"}, 53472),
    Preset(
        "paper-simd",
        "SIMD inside the collision",
        {**_PAPER, **_MASKS, "rsqrt": "inv", "simd": "balls"},
        64760,
    ),
    Preset(
        "paper-simd-rewritten",
        "SIMD inside the collision, rewritten",
        {**_PAPER, **_MASKS, "rsqrt": "est1", "simd": "balls"},
        46533,
    ),
    Preset(
        "paper-prepost",
        "scalar loop with SIMD before and after it",
        {**_PAPER, "reuse": "precompute", "rsqrt": "inv", "roots": "two", "simd": "prepost"},
    ),
    Preset(
        "paper-less-roots",
        "two square roots an iteration",
        {**_NO_FMA, "reuse": "precompute", "roots": "two", "rsqrt": "inv"},
    ),
    Preset("paper-best", "rsqrt, Newton, inverted branches", {**_PAPER, **_BEST}, 33240),
    Preset(
        "paper-best-twostage",
        "the same with a two-stage loop",
        {**_PAPER, **_BEST, "loop": "twostage"},
        33739,
    ),
)

_REDUCED = {"state": "reduced", "reuse": "factored", "roots": "early", "branch": "chosen"}

OWN_PRESETS: tuple[Preset, ...] = (
    Preset(
        "reduced",
        "the slips alone, one pressed ball, sqrt and divide",
        {**_REDUCED, "rsqrt": "inv", "reuse": "precompute"},
    ),
    Preset(
        "reduced-ahead",
        "the same, 1/|c| extrapolated and refined, multiplied in last",
        {**_REDUCED, "rsqrt": "ahead", "order": "chain"},
    ),
)

PRESETS = PAPER_PRESETS + OWN_PRESETS
BASELINE = PAPER_PRESETS[0]


def find_preset(name: str) -> Preset:
    """A preset by its name. Raises InputError naming the presets there are."""
    for preset in PRESETS:
        if preset.name == name:
            return preset
    names = ", ".join(preset.name for preset in PRESETS)
    raise InputError(f"no preset or kernel '{name}'; presets are {names}")
