"""The table of the main job: speed against error of every candidate, readable at 80 columns."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from rich.console import Console
from rich.table import Table

from ..choice.choose import Choice
from ..choice.workbench import Candidate
from ..registry.axes import axis
from ..registry.names import source_name_of
from ..registry.presets import PAPER_PRESETS
from ..registry.variant import Variant, make_variant
from ..targets.target import Target, find_target

LEAST_WIDTH = 80
ROOMY = 108  # columns from which on the clock's cycles have room too


def show_table(
    console: Console, candidates: Sequence[Candidate], choice: Choice, target: Target
) -> None:
    """The table, then a line for each candidate that was rejected."""
    shown = _shown(candidates)
    roomy = console.width >= ROOMY
    ordered = sorted(candidates, key=lambda c: _rank(c))
    base = _base([c.variant for c in ordered if not preset_of(c.variant)])
    head = f"{target.name}: speed against error, {choice.evidence}"
    console.print(head, highlight=False, soft_wrap=True)
    table = Table(show_edge=False, pad_edge=False, collapse_padding=True)
    table.add_column("kernel: options", ratio=1, overflow="fold")
    for title in _titles(shown, target, roomy):
        table.add_column(title, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    for c in ordered:
        figures = _figures(c, shown, roomy)
        table.add_row(_label(c.variant, base), *figures, _mark(c, choice))
    console.print(table)
    console.print(
        "options: of the report's rows (paper-...) those that differ from paper-initial, of ours "
        f"those that differ from {' '.join(base.values())}",
        highlight=False,
    )
    for c in ordered:
        if c.rejected:
            console.print(
                f"rejected {_label(c.variant, base)}: {c.rejected}", highlight=False, markup=False
            )


def preset_of(variant: Variant) -> str:
    """The report's name for a variant, whichever compiler makes it, or empty."""
    if variant.stepper.family != "euler":
        return ""
    for preset in PAPER_PRESETS:
        options = {**preset.options, "compiler": variant["compiler"]}
        if not find_target(variant.target).has("fma"):
            options["fma"] = "nofma"
        same = make_variant(
            variant.target, variant.scene, variant.model, variant.stepper, **options
        )
        if same.options == variant.options:
            return preset.name
    return ""


@dataclass(frozen=True)
class _Shown:
    """Which figures the candidates of a table have."""

    modelled: bool
    recorded: bool
    timed: bool


def _shown(candidates: Sequence[Candidate]) -> _Shown:
    return _Shown(
        any(c.modelled for c in candidates),
        any(c.recorded for c in candidates),
        any(c.timing for c in candidates),
    )


def _base(variants: Sequence[Variant]) -> dict[str, str]:
    """For each option the code that most of our candidates have."""
    keys = [key for key, _ in variants[-1].options] if variants else []
    base = {}
    for key in keys:
        counts = Counter(v.get(key) for v in variants)
        codes = axis(key).codes()
        base[key] = max(codes, key=lambda code: (counts[code], -codes.index(code)))
    return base


def _label(variant: Variant, base: dict[str, str]) -> str:
    preset = preset_of(variant)
    if not preset:
        differing = [code for key, code in variant.options if base.get(key) != code]
        exact = variant.stepper.family == "exact"
        head = variant.stepper.name if exact else "ours"
        head = f"{head} x{variant.width}" if variant.width > 1 else head
        return f"{head}: {' '.join(differing) or '(as below)'}"
    initial = {"compiler": "gcc", **PAPER_PRESETS[0].options}
    differing = [c for k, c in variant.options if c != initial.get(k, axis(k).default)]
    return f"{preset}: {' '.join(differing)}" if differing else preset


def _titles(shown: _Shown, target: Target, roomy: bool) -> list[str]:
    titles = [f"cycles\n{target.row.mca_cpu}\n(llvm-mca)"] if shown.modelled else []
    titles += ["ns\nrecorded"] if shown.recorded else []
    if shown.timed:
        titles += ["ns", "ns\nlatency", "ns\nseed\ncases", *(["TSC\ncycles"] if roomy else [])]
    ratio = ["ratio to\npaper-initial\n(95 %)"] if shown.timed or shown.recorded else []
    return [*titles, *ratio, "largest\nerror\nm/s"]


def _figures(candidate: Candidate, shown: _Shown, roomy: bool) -> list[str]:
    timing, model, found = candidate.timing, candidate.modelled, candidate.recorded
    row = []
    if shown.modelled:
        row.append(f"{model.cycles:.0f}" if model else "-")
    if shown.recorded:
        row.append(f"{found.record.ns:.0f}" if found else "-")
    if shown.timed:
        times = (timing.ns, timing.latency_ns, timing.seed_ns) if timing else (None, None, None)
        times = (*times, timing.cycles if timing else None) if roomy else times
        row += ["-" if ns is None else f"{ns:.0f}" for ns in times]
    measured = timing or (found.record if found else None)
    if shown.timed or shown.recorded:
        low, high = measured.ratio_ci if measured else (0.0, 0.0)
        row.append(f"{measured.ratio:.3f}\n{low:.3f}-{high:.3f}" if measured else "-")
    return [*row, _error(candidate)]


def _error(candidate: Candidate) -> str:
    """Against the scheme in m/s for fixed steps, against the exact result and relative else."""
    if candidate.verdict is None:
        return "-"
    if candidate.variant.stepper.family == "exact":
        return f"{candidate.verdict.max_rel_error:.1e}\nrelative"
    return f"{candidate.verdict.max_abs_error:.1e}"


def _mark(candidate: Candidate, choice: Choice) -> str:
    if candidate.rejected:
        return "rejected"
    if candidate is choice.chosen:
        return "chosen"
    return "tie" if candidate.name in choice.ties else ""


def _rank(candidate: Candidate) -> tuple[int, float, str]:
    if candidate.rejected:
        return 3, 0.0, candidate.name
    if candidate.timing is not None:
        return 0, candidate.timing.ratio, candidate.name
    if candidate.recorded is not None:
        return 0, candidate.recorded.record.ratio, candidate.name
    if candidate.modelled is not None:
        return 1, candidate.modelled.cycles, candidate.name
    return 2, 0.0, source_name_of(candidate.variant)
