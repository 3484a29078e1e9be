"""The figures of Li, Egger, Ruff and Pfingsten, "Optimizing ball to ball collisions on Zen 3
architecture" (ETH): mean cycles over five cases, N = 1000, Ryzen 7 7735U. None of theirs is ours.
"""

from __future__ import annotations

from typing import Any

from ...registry.presets import PAPER_PRESETS
from ..experiments.subjects import BASELINE
from ..known import Known
from ..layout import Block, Paragraph, Section, number, records, text

NUMBA_CYCLES = 129037
SPMD = "SPMD over 4 lanes: half the time of 4 sequential `best`"
NOT_KNOWN = (
    "flops by kind, flops per cycle, branch and cache misses, llvm-mca pressure, growth with N, "
    "GCC against Clang and the Apple M1 are in the report, but their numbers are not known here: "
    "only the mean cycles below are"
)


def section(known: Known) -> Section:
    rows = published_rows(known)
    columns = [
        text("row", "text"),
        text("preset", "preset"),
        number("theirs, cycles", "count", "their_cycles"),
        number("of their initial C", "times", "their_ratio"),
        number("ours, cycles", "count", "our_cycles"),
        number("of ours", "times", "our_ratio"),
        text("note", "note"),
    ]
    what = (
        "Li, Egger, Ruff, Pfingsten, 'Optimizing ball to ball collisions on Zen 3 architecture' "
        "(ETH): mean cycles over its five cases, N = 1000, Ryzen 7 7735U. Ours: the same rows as "
        "variants, on the same five cases, in cycles of this machine's time stamp counter "
        f"({known.cpu}); compare ratios, not cycles."
    )
    blocks: list[Block] = [
        Paragraph([what]),
        Paragraph([f"{NOT_KNOWN}."], "note"),
        records(("published",), rows, columns),
    ]
    title, missing = "The report's own figures beside ours", {"published": NOT_KNOWN}
    data = {"published": rows}
    return Section("published", "The report's figures", title, data, blocks, missing)


def published_rows(known: Known) -> list[dict[str, Any]]:
    """The report's rows in its order, ours beside them where there is one."""
    ours = {k.role: k.seed_cycles for k in known.kernels if k.seed_cycles}
    theirs = {p.name: p.report_cycles for p in PAPER_PRESETS}
    rows = [_row("numba, as pooltool had it", "", NUMBA_CYCLES, "Python; no kernel of ours")]
    for preset in PAPER_PRESETS:
        note = "" if preset.name in ours else "not measured: ./gen report --measure"
        if theirs[preset.name] is None:
            note = "the report's cycles for this row are not known here"
        rows.append(_row(preset.text, preset.name, theirs[preset.name], note))
    for row in rows:
        cycles, own = row["their_cycles"], ours.get(row["preset"])
        first, own_first = theirs[BASELINE], ours.get(BASELINE)
        row["their_ratio"] = cycles / first if cycles and first else None
        row["our_cycles"] = own
        row["our_ratio"] = own / own_first if own and own_first else None
    return [*rows, _spmd(known)]


def _row(words: str, preset: str, cycles: int | None, note: str) -> dict[str, Any]:
    return {"text": words, "preset": preset, "their_cycles": cycles, "note": note}


def _spmd(known: Known) -> dict[str, Any]:
    lanes = [row for row in (known.findings.calls if known.findings else ()) if row.width > 1]
    best = min(lanes, key=lambda row: row.timed.ratio, default=None)
    note = "no kernel with lanes was measured"
    if best is not None:
        note = f"{best.role}, {best.width} lanes against its scalar call, mixed cases"
    ratio = best.timed.ratio if best else None
    return {
        **_row(SPMD, "", None, note),
        "their_ratio": 0.5,
        "our_cycles": None,
        "our_ratio": ratio,
    }
