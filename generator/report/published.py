"""The figures of Li, Egger, Ruff and Pfingsten, "Optimizing ball to ball collisions on Zen 3
architecture" (ETH): mean cycles over five cases, N = 1000, Ryzen 7 7735U. Nothing here is ours.
"""

from __future__ import annotations

from ..registry.presets import PAPER_PRESETS
from .data import PublishedRow
from .measured import CallPoint, Measured
from .subjects import BASELINE

CPU = "Ryzen 7 7735U (Zen 3)"
NUMBA_CYCLES = 129037
SPMD = "SPMD over 4 lanes: half the time of 4 sequential `best`"
NOT_KNOWN = (
    "flops by kind, flops per cycle, branch and cache misses, llvm-mca pressure, growth with N, "
    "GCC against Clang and the Apple M1 are in the report, but their numbers are not known here: "
    "only the mean cycles below are"
)


def published_rows(measured: Measured | None, calls: tuple[CallPoint, ...]) -> list[PublishedRow]:
    """The report's rows in its order, ours beside them where there is one."""
    theirs = {p.name: p.report_cycles for p in PAPER_PRESETS}
    their_first = theirs[BASELINE]
    our_first = _our_cycles(measured, BASELINE)
    assert their_first is not None
    rows = [
        PublishedRow(
            text="numba, as pooltool had it",
            preset="",
            their_cycles=NUMBA_CYCLES,
            their_ratio=NUMBA_CYCLES / their_first,
            our_cycles=None,
            our_ratio=None,
            note="Python; no kernel of ours",
        )
    ]
    for preset in PAPER_PRESETS:
        cycles, ours = theirs[preset.name], _our_cycles(measured, preset.name)
        note = "" if cycles else "the report's cycles for this row are not known here"
        rows.append(
            PublishedRow(
                text=preset.text,
                preset=preset.name,
                their_cycles=cycles,
                their_ratio=cycles / their_first if cycles else None,
                our_cycles=ours,
                our_ratio=ours / our_first if ours and our_first else None,
                note=note or ("" if ours else "not measured: ./gen report --measure"),
            )
        )
    rows.append(_spmd(calls))
    return rows


def _our_cycles(measured: Measured | None, role: str) -> float | None:
    kernel = measured.find(role) if measured else None
    return kernel.timed.seed_cycles if kernel and kernel.timed else None


def _spmd(calls: tuple[CallPoint, ...]) -> PublishedRow:
    lanes = [row for row in calls if row.width > 1]
    best = min(lanes, key=lambda row: row.ratio, default=None)
    note = "no kernel with lanes was measured"
    if best is not None:
        note = f"{best.role}, {best.width} lanes against its scalar call, mixed cases"
    return PublishedRow(
        text=SPMD,
        preset="",
        their_cycles=None,
        their_ratio=0.5,
        our_cycles=None,
        our_ratio=best.ratio if best else None,
        note=note,
    )
