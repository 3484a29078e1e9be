"""Which plots the page has, out of the report's data."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from generator.profiling.sections import SECTIONS
from generator.report.data import Contest, PlainPoint, Report, VariantPoint
from generator.report.plots import (
    COLOURS,
    LegendEntry,
    Plot,
    Point,
    Rows,
    nanoseconds,
    ratio_rows,
    scatter,
    stacked_rows,
)
from generator.report.subjects import BASELINE
from generator.variants.axes import axis

_COMPILERS = {"gcc": ("circle", "GCC"), "clang": ("square", "Clang, newest")}
_COMPILERS |= {"clangold": ("triangle", "Clang, the system's")}
_PLAIN = {
    "report": ("star", 7, "the report's kernels"),
    "chosen": ("diamond", 0, "chosen kernels, as measured"),
    "euler": ("cross", 1, "fixed-step Euler, other N"),
}
_FRONT = LegendEntry("dashed", None, "Pareto front: no other is faster and more exact")
_TIE = LegendEntry("ring", None, "ties with the fastest")


def plots_of(report: Report) -> dict[str, tuple[Plot | Rows, ...]]:
    """Plots by the section of the page that they stand in."""
    return {
        "contests": tuple(_contest_plots(report)),
        "effects": tuple(_effect_plots(report)),
        "growth": tuple(_growth_plots(report)),
        "sections": tuple(_section_plots(report)),
    }


# -- time against error --


def _contest_plots(report: Report) -> list[Plot]:
    base = _base_ns(report)
    found = []
    for call in ("scalar", "batch"):
        exact = [c for c in report.contests if c.family == "exact" and c.call == call]
        points = report.points if call == "scalar" else ()
        if exact or points:
            found.append(_exact_plot(exact, points, call, base))
        euler = [c for c in report.contests if c.family == "euler" and c.call == call]
        found += [_euler_plot(contest, base) for contest in euler]
    return found


def _base_ns(report: Report) -> float | None:
    first = next((c for c in report.chosen if c.role == BASELINE and c.ns and c.ratio), None)
    if first is not None:
        return first.ns / first.ratio  # type: ignore[operator]
    ratios = [v.ns / v.ratio for c in report.contests for v in c.variants]
    return sorted(ratios)[len(ratios) // 2] if ratios else None


def _exact_plot(
    contests: Sequence[Contest], points: Sequence[PlainPoint], call: str, base: float | None
) -> Plot:
    marks = [
        _variant(v, contest, (2 + n) % COLOURS)
        for n, contest in enumerate(contests)
        for v in contest.variants
    ]
    legend = [
        LegendEntry("bar", (2 + n) % COLOURS, f"variants for {contest.goal}")
        for n, contest in enumerate(contests)
    ]
    legend += _shapes(v for c in contests for v in c.variants)
    for group, (shape, colour, text) in _PLAIN.items():
        own = [p for p in points if p.group == group]
        if own:
            legend.append(LegendEntry(shape, colour, text))
        marks += [Point(p.error, p.ratio, shape, colour, _plain_title(p)) for p in own]
    marks = [m for m in marks if m.x > 0]
    return scatter(
        f"exact-{call}",
        f"Time against the error to the exact result ({call} calls)",
        marks,
        [*legend, _FRONT, *_ties(marks), *_band_legend(contests)],
        "largest error of any case, relative to |v1 \u2212 v2|",
        "time / time of paper-initial",
        front=_front(marks),
        bands=_bands(contests),
        base_ns=base,
    )


def _euler_plot(contest: Contest, base: float | None) -> Plot:
    codes = list(axis("rsqrt").codes())
    index = contest.axes.index("rsqrt") if "rsqrt" in contest.axes else None

    def colour(variant: VariantPoint) -> int:
        code = variant.options[index] if index is not None else codes[0]
        return codes.index(code) % COLOURS if code in codes else COLOURS - 1

    marks = [_variant(v, contest, colour(v)) for v in contest.variants if v.error > 0]
    used = sorted({m.colour for m in marks})
    texts = {choice.code: choice.text for choice in axis("rsqrt").choices}
    legend = [LegendEntry("bar", c, f"1/|c|: {texts[codes[c]]}") for c in used if c < len(codes)]
    return scatter(
        f"euler-{contest.call}-{contest.goal.replace(' ', '')}",
        f"Fixed steps, {contest.goal}: time against rounding ({contest.call} calls)",
        marks,
        [
            *legend,
            *_shapes(contest.variants),
            _FRONT,
            *_ties(marks),
            *_band_legend([contest]),
        ],
        "largest error against the same scheme in long double, relative to |v1 \u2212 v2|",
        "time / time of paper-initial",
        front=_front(marks),
        bands=_bands([contest]),
        base_ns=base,
    )


def _variant(v: VariantPoint, contest: Contest, colour: int) -> Point:
    options = dict(zip(contest.axes, v.options, strict=True))
    shape = _COMPILERS.get(options.get("compiler", ""), ("circle", ""))[0]
    low, high = v.ratio_ci
    lanes = f", {v.width} lanes" if v.width > 1 else ""
    title = (
        f"{v.stepper}{lanes}, {contest.goal}: {', '.join(f'{k} {c}' for k, c in options.items())}\n"
        f"{nanoseconds(float(f'{v.ns:.3g}'))}, {v.ratio:.4g} ({low:.4g} to {high:.4g}) of "
        f"paper-initial, error {v.error:.1e}{', tie' if v.tie else ''}"
    )
    return Point(v.error, v.ratio, shape, colour, title, v.front, v.tie)


def _plain_title(p: PlainPoint) -> str:
    time = nanoseconds(float(f"{p.ns:.3g}"))
    return f"{p.label}\n{time}, {p.ratio:.4g} of paper-initial, error {p.error:.1e}"


def _shapes(variants: Iterable[VariantPoint]) -> list[LegendEntry]:
    used = {code for v in variants for code in v.options}
    return [LegendEntry(shape, None, t) for code, (shape, t) in _COMPILERS.items() if code in used]


def _ties(marks: Iterable[Point]) -> list[LegendEntry]:
    return [_TIE] if any(mark.tie for mark in marks) else []


def _front(points: Sequence[Point]) -> list[tuple[float, float]]:
    front: list[tuple[float, float]] = []
    for point in sorted(points, key=lambda p: (p.y, p.x)):
        if not front or point.x < front[-1][0]:
            front.append((point.x, point.y))
    return front


def _bands(contests: Sequence[Contest]) -> list[tuple[float, float, str]]:
    return [(*c.band, f"{c.goal}: ties") for c in contests if c.band is not None]


def _band_legend(contests: Sequence[Contest]) -> list[LegendEntry]:
    bands = [c.band for c in contests if c.band]
    if not bands:
        return []
    width = max(high / low - 1 for low, high in bands) / 2
    text = f"tie band: \u00b1{100 * width:.1f} % about the fastest of a final (A/A control)"
    return [LegendEntry("band", None, text)]


# -- the others --


def _effect_plots(report: Report) -> list[Rows]:
    """What each option does against the axis' default; all pairs are in the table."""
    found = []
    for family in ("euler", "exact"):
        own = [e for e in report.effects if e.family == family and e.other == _default(e.axis)]
        rows = []
        for effect in own:
            low, high = effect.ratio_ci
            sure = 0 if high < 1 else 5 if low > 1 else 7
            label = f"{effect.axis}: {effect.code}, not {effect.other}"
            text = f"{effect.text}\n{effect.ratio:.4g} ({low:.4g} to {high:.4g}), {effect.pairs}"
            rows.append((label, effect.ratio, (low, high), sure, f"{text} pairs"))
        if rows:
            title = f"What each option does by itself ({family} kernels)"
            label = "time with the option / time without, median of pairs and 95 % interval"
            legend = [
                LegendEntry("bar", 0, "faster"),
                LegendEntry("bar", 5, "slower"),
                LegendEntry("bar", 7, "cannot be told"),
                LegendEntry("line", None, "interval"),
            ]
            found.append(ratio_rows(f"effects-{family}", title, label, rows, legend))
    return found


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
    rows = [
        (
            s.role,
            [
                (s.shares[name], f"{s.role}, {name}: {100 * s.shares[name]:.1f} %")
                for name in SECTIONS
            ],
        )
        for s in report.sections
    ]
    legend = [LegendEntry("bar", n, name) for n, name in enumerate(SECTIONS)]
    label = "share of the samples of the program counter, %"
    return [stacked_rows("sections", "Where the time goes", label, rows, legend)]
