"""Plots of time against error: one mark for each variant."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..registry.axes import axis
from .contests import MORE_EXACT
from .data import Contest, PlainPoint, Report, VariantPoint
from .plots import COLOURS, LegendEntry, Plot, Point, nanoseconds, scatter
from .subjects import BASELINE

_COMPILERS = {"gcc": ("circle", "GCC"), "clang": ("square", "Clang, newest")}
_COMPILERS |= {"clangold": ("triangle", "Clang, the system's")}
_PLAIN = {
    "report": ("star", 7, "the report's kernels"),
    "chosen": ("diamond", 0, "chosen kernels, as measured"),
    "euler": ("cross", 1, "fixed-step Euler, other N"),
}
_FRONT = LegendEntry("dashed", None, "Pareto front: no other is faster and more exact")
_TIE = LegendEntry("ring", None, "ties with the fastest")


def contest_plots(report: Report) -> list[Plot]:
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
    codes = ", ".join(f"{key} {code}" for key, code in options.items() if code)
    title = (
        f"{v.stepper}{lanes}, {contest.goal}: {codes}\n"
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
        if not front or point.x < MORE_EXACT * front[-1][0]:
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
