"""Which plots the page has, out of the report's data."""

from __future__ import annotations

from collections.abc import Iterable

from ..evidence.profiling.sections import SECTIONS
from ..registry.axes import axis
from .contest_plots import contest_plots
from .data import Effect, Report
from .plots import LegendEntry, Plot, Point, nanoseconds, scatter
from .row_plots import Rows, ratio_rows, stacked_rows

FEWEST_PAIRS = 6  # with fewer, no interval of order statistics holds the median in 95 %


def plots_of(report: Report) -> dict[str, tuple[Plot | Rows, ...]]:
    """Plots by the section of the page that they stand in."""
    return {
        "contests": tuple(contest_plots(report)),
        "effects": tuple(_effect_plots(report)),
        "growth": tuple(_growth_plots(report)),
        "sections": tuple(_section_plots(report)),
    }


def _effect_plots(report: Report) -> list[Rows]:
    """What each option does, a row each; all pairs are in the table."""
    found = []
    for family in ("euler", "exact"):
        own = one_each(e for e in report.effects if e.family == family)
        rows = []
        for effect in own:
            low, high = effect.ratio_ci
            sure = 0 if high < 1 else 5 if low > 1 else 7
            if effect.pairs < FEWEST_PAIRS:
                sure = 7
            label = f"{effect.axis}: {effect.code}, not {effect.other}"
            text = f"{effect.text}\n{effect.ratio:.4g} ({low:.4g} to {high:.4g}), {effect.pairs}"
            rows.append((label, effect.ratio, (low, high), sure, f"{text} pairs"))
        if rows:
            title = f"What each option does by itself ({family} kernels)"
            label = "time with the option / time without, median of pairs and 95 % interval"
            legend = [
                LegendEntry("bar", 0, "faster"),
                LegendEntry("bar", 5, "slower"),
                LegendEntry("bar", 7, f"cannot be told, or fewer than {FEWEST_PAIRS} pairs"),
                LegendEntry("line", None, "interval"),
            ]
            found.append(ratio_rows(f"effects-{family}", title, label, rows, legend))
    return found


def one_each(effects: Iterable[Effect]) -> list[Effect]:
    """Each option against its axis' default or, where no pair has that, in the most pairs."""
    found: dict[tuple[str, str], Effect] = {}
    for effect in effects:
        known = found.setdefault((effect.axis, effect.code), effect)
        if _rank(effect) > _rank(known):
            found[effect.axis, effect.code] = effect
    return list(found.values())


def _rank(effect: Effect) -> tuple[bool, int]:
    return effect.other == _default(effect.axis), effect.pairs


def _default(key: str) -> str:
    try:
        return axis(key).default
    except KeyError:
        return ""


def _growth_plots(report: Report) -> list[Plot]:
    if not report.growth:
        return []
    roles = list(dict.fromkeys(row.role for row in report.growth))
    shapes = dict(zip(roles, ("star", "circle"), strict=False))
    colours = dict(zip(roles, (7, 1), strict=False))
    times, errors, time_lines, error_lines = [], [], [], []
    for role in roles:
        own = [row for row in report.growth if row.role == role]
        for row in own:
            text = f"{role}, N = {row.steps}\n{nanoseconds(float(f'{row.ns:.3g}'))}"
            times.append(Point(row.steps, row.ns, shapes[role], colours[role], text))
        time_lines.append((colours[role], [(row.steps, row.ns) for row in own]))
    for row in (r for r in report.growth if r.role == roles[-1]):
        for value, colour, what in (
            (row.error, 5, "all contacts"),
            (row.slipping_error, 2, "contacts that slip to the end"),
        ):
            text = f"{roles[-1]}, N = {row.steps}\n{what}: {value:.2e}"
            errors.append(Point(row.steps, value, "circle", colour, text))
    own = [row for row in report.growth if row.role == roles[-1]]
    error_lines += [(5, [(r.steps, r.error) for r in own])]
    error_lines += [(2, [(r.steps, r.slipping_error) for r in own if r.slipping_error > 0])]
    return [
        scatter(
            "growth-time",
            "Time grows with N",
            times,
            [LegendEntry(shapes[role], colours[role], role) for role in roles],
            "N, steps of the scheme",
            "time for a collision",
            y_text=nanoseconds,
            series=time_lines,
        ),
        scatter(
            "growth-error",
            f"Error falls with N while the contact slips ({roles[-1]})",
            [p for p in errors if p.y > 0],
            [
                LegendEntry("circle", 5, "all cases"),
                LegendEntry("circle", 2, "contacts that slip to the end"),
            ],
            "N, steps of the scheme",
            "largest error, relative to |v1 \u2212 v2|",
            series=error_lines,
        ),
    ]


def _section_plots(report: Report) -> list[Rows]:
    if not report.sections:
        return []
    rows = []
    for s in report.sections:
        shares = {**s.shares, "no line": s.unknown}
        named = [
            (shares[n], f"{s.role}, {n}: {100 * shares[n]:.1f} %") for n in (*SECTIONS, "no line")
        ]
        rows.append((s.role, named))
    legend = [LegendEntry("bar", n, name) for n, name in enumerate((*SECTIONS, "no line"))]
    label = "share of the samples of the program counter, %"
    return [stacked_rows("sections", "Where the time goes", label, rows, legend)]
