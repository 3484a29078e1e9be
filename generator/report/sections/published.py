"""The figures of Li, Egger, Ruff and Pfingsten (ETH): mean cycles over five cases, N = 1000, on a
Ryzen 7 7735U. None of theirs is ours.
"""

from __future__ import annotations

from typing import Any

from ...registry.question import DEFAULT_IMPACT, find_impact
from ..experiments.subjects import BASELINE
from ..known import Known

NUMBA_CYCLES = 129037
SPMD = "SPMD over 4 lanes: half the time of 4 sequential `best`"
NOT_KNOWN = (
    "flops by kind, flops per cycle, branch and cache misses, llvm-mca pressure, growth with N, "
    "GCC against Clang and the Apple M1 are in the report, but their numbers are not known here: "
    "only the mean cycles below are"
)
_THEIRS = "the report's cycles for this row are not known here"


def published_rows(known: Known) -> list[dict[str, Any]]:
    """The report's rows in its order, ours beside them where there is one."""
    ours = {k.role: k.seed_cycles for k in known.kernels if k.seed_cycles}
    presets = find_impact(DEFAULT_IMPACT).part("presets").PAPER_PRESETS
    theirs = {p.name: p.report_cycles for p in presets}
    rows: list[tuple[str, str, int | None, str]] = [
        ("numba, as pooltool had it", "", NUMBA_CYCLES, "Python; no kernel of ours")
    ]
    for p in presets:
        note = "" if p.name in ours else "not measured: ./gen report --measure"
        rows.append((p.text, p.name, p.report_cycles, note if p.report_cycles else _THEIRS))
    found = [
        {
            "text": text,
            "preset": name,
            "their_cycles": cycles,
            "their_ratio": _ratio(cycles, theirs[BASELINE]),
            "our_cycles": ours.get(name),
            "our_ratio": _ratio(ours.get(name), ours.get(BASELINE)),
            "note": note,
        }
        for text, name, cycles, note in rows
    ]
    return [*found, {**dict.fromkeys(found[0]), **_spmd(known)}]


def _ratio(cycles: float | None, first: float | None) -> float | None:
    return cycles / first if cycles and first else None


def _spmd(known: Known) -> dict[str, Any]:
    lanes = [row for row in (known.findings.calls if known.findings else ()) if row.width > 1]
    best = min(lanes, key=lambda row: row.timed.ratio, default=None)
    note = "no kernel with lanes was measured"
    if best is not None:
        note = f"{best.role}, {best.width} lanes against its scalar call, mixed cases"
    ratio = best.timed.ratio if best else None
    return {"text": SPMD, "preset": "", "their_ratio": 0.5, "our_ratio": ratio, "note": note}
