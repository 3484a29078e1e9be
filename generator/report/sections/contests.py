"""Time against error: one mark for each variant that was timed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ...registry.axes import axis
from ..contests import MORE_EXACT, ContestTable, Entrant, summary_of
from ..drawing import COLOURS
from ..experiments.subjects import BASELINE, BEST, EULER
from ..known import Known
from ..plots import Key, Mark, Plot, Scatter, nanoseconds, scatter

_COMPILERS = {"gcc": ("o", "GCC"), "clang": ("s", "Clang, newest")}
_COMPILERS |= {"clangold": ("^", "Clang, the system's")}
_POINTS = {
    "report": ("*", 7, "the report's kernels"),
    "chosen": ("D", 0, "chosen kernels, as measured"),
    "euler": ("x", 1, "fixed-step Euler, other N"),
}
_FRONT = Key("dashed", None, "Pareto front: no other is faster and more exact")
_TIE = Key("ring", None, "ties with the fastest")
_CHOSEN = Key("box", None, "chosen; a mark below it says why it was not")
_LABEL = "largest error{}, relative to |v1 \u2212 v2|"


def data(known: Known) -> dict[str, Any]:
    found: dict[str, Any] = {"contests": [contest.row() for contest in known.contests]}
    found |= {"points": points_of(known), "sweep": None}
    if trials := known.stored.trials:
        times = sorted(trial.made_at for trial in trials)
        commands = [*dict.fromkeys(run.command for run in known.stored.runs)]
        found["sweep"] = {"commands": commands, "from_to": (times[0], times[-1])}
        found["sweep"] |= summary_of(trials)
    return found


def points_of(known: Known) -> list[dict[str, Any]]:
    """The chosen kernels, the report's, and fixed steps with other N, by their exact errors."""
    found = [
        {
            "label": kernel.role,
            "group": "report" if kernel.role in (BASELINE, BEST) else "chosen",
            "ns": kernel.timed.ns,
            "ratio": kernel.timed.ratio,
            "error": kernel.error,
        }
        for kernel in known.kernels
        if kernel.timed and kernel.error is not None
    ]
    base = _base_ns(known)
    if known.findings and base:
        found += [
            {
                "label": f"Euler, N = {point.steps}",
                "group": "euler",
                "ns": point.ns,
                "ratio": point.ns / base,
                "error": point.error,
            }
            for point in known.findings.growth
            if point.role == EULER
        ]
    return found


def _base_ns(known: Known) -> float | None:
    """What paper-initial takes: as measured, else as in the middle of the sweep's trials."""
    first = known.findings and known.findings.find(BASELINE)
    if first and first.timed:
        return first.timed.ns / first.timed.ratio
    bases = sorted(e.times.ns / e.ratio for c in known.contests for e in c.variants)
    return bases[len(bases) // 2] if bases else None


def contest_plots(known: Known, points: Sequence[dict[str, Any]]) -> list[Plot]:
    base = _base_ns(known)
    found = []
    numbered = list(enumerate(known.contests))
    for call in ("scalar", "batch"):
        own = [(n, c) for n, c in numbered if c.call == call]
        exact = [(n, c) for n, c in own if c.family == "exact"]
        beside = points if call == "scalar" else ()
        if exact or beside:
            found.append(scatter(_exact(exact, beside, call, base)))
        found += [scatter(_euler(n, c, base)) for n, c in own if c.family == "euler"]
    return found


def _exact(
    contests: Sequence[tuple[int, ContestTable]],
    points: Sequence[dict[str, Any]],
    call: str,
    base: float | None,
) -> Scatter:
    colours = [(2 + n) % len(COLOURS) for n in range(len(contests))]
    marks = [
        _mark(n, index, contest, colour)
        for (n, contest), colour in zip(contests, colours, strict=True)
        for index in range(len(contest.variants))
    ]
    own = [contest for _, contest in contests]
    legend = [Key("bar", c, f"variants for {o.goal}") for c, o in zip(colours, own, strict=True)]
    legend += _shapes(e for contest in own for e in contest.variants)
    for group, (shape, colour, name) in _POINTS.items():
        there = [(n, p) for n, p in enumerate(points) if p["group"] == group]
        legend += [Key(shape, colour, name)] if there else []
        marks += [
            Mark(p["error"], p["ratio"], shape, colour, _point_text(p), f"/points/{n}")
            for n, p in there
        ]
    marks = [m for m in marks if m.x > 0]
    return Scatter(
        f"exact-{call}",
        f"Time against the error to the exact result ({call} calls)",
        marks,
        [*legend, *_legend(marks, own)],
        (_LABEL.format(" of any case"), "time / time of paper-initial"),
        ("error", "ratio"),
        front=_front(marks),
        bands=[contest.band for contest in own if contest.band],
        base_ns=base,
    )


def _euler(n: int, contest: ContestTable, base: float | None) -> Scatter:
    """Coloured by how 1/|c| is made."""
    codes = list(axis("rsqrt").codes())
    texts = {choice.code: choice.text for choice in axis("rsqrt").choices}

    def colour(entrant: Entrant) -> int:
        code = entrant.trial.subject.options.get("rsqrt", codes[0])
        return codes.index(code) % len(COLOURS) if code in codes else len(COLOURS) - 1

    marks = [
        _mark(n, index, contest, colour(e))
        for index, e in enumerate(contest.variants)
        if e.error > 0
    ]
    used = sorted({m.colour for m in marks})
    legend = [Key("bar", c, f"1/|c|: {texts[codes[c]]}") for c in used if c < len(codes)]
    return Scatter(
        f"euler-{contest.call}-{contest.goal.replace(' ', '')}",
        f"Fixed steps, {contest.goal}: time against rounding ({contest.call} calls)",
        marks,
        [*legend, *_shapes(contest.variants), *_legend(marks, [contest])],
        (_LABEL.format(" against the same scheme in long double"), "time / time of paper-initial"),
        ("error", "ratio"),
        front=_front(marks),
        bands=[contest.band] if contest.band else [],
        base_ns=base,
    )


def _mark(n: int, index: int, contest: ContestTable, colour: int) -> Mark:
    entrant = contest.variants[index]
    subject, (low, high) = entrant.trial.subject, entrant.times.ratio_ci
    shape = _COMPILERS.get(subject.options.get("compiler", ""), ("o", ""))[0]
    width = subject.asked.width.lanes
    lanes = f", {width} lanes" if width > 1 else ""
    codes = ", ".join(f"{key} {code}" for key, code in subject.options.items() if code)
    standing = "".join(f", {word}" for word in ("chosen", "tie") if getattr(entrant, word))
    words = (
        f"{subject.stepper}{lanes}, {contest.goal}: {codes}\n"
        f"{nanoseconds(entrant.times.ns)}, {entrant.ratio:.4g} ({low:.4g} to {high:.4g}) of "
        f"paper-initial, error {entrant.error:.1e}{standing}"
    )
    if entrant.why:
        words += f"\nnot chosen: {entrant.why}"
    return Mark(
        entrant.error,
        entrant.ratio,
        shape,
        colour,
        words,
        f"/contests/{n}/variants/{index}",
        entrant.front,
        entrant.tie,
        entrant.chosen,
    )


def _point_text(p: dict[str, Any]) -> str:
    time = nanoseconds(p["ns"])
    return f"{p['label']}\n{time}, {p['ratio']:.4g} of paper-initial, error {p['error']:.1e}"


def _shapes(entrants: Iterable[Entrant]) -> list[Key]:
    used = {e.trial.subject.options.get("compiler") for e in entrants}
    return [Key(shape, None, name) for code, (shape, name) in _COMPILERS.items() if code in used]


def _legend(marks: Iterable[Mark], contests: Sequence[ContestTable]) -> list[Key]:
    """The front, and what there is of chosen marks, ties and their bands."""
    found = [_FRONT]
    found += [_CHOSEN] if any(mark.chosen for mark in marks) else []
    found += [_TIE] if any(mark.tie for mark in marks) else []
    if bands := [contest.band for contest in contests if contest.band]:
        width = max(high / low - 1 for low, high in bands) / 2
        words = f"tie band: \u00b1{100 * width:.1f} % about the fastest of a final (A/A control)"
        found.append(Key("band", 6, words))
    return found


def _front(marks: Sequence[Mark]) -> list[tuple[float, float]]:
    """From the fastest to the most exact: left and down of it lies what no kernel reaches."""
    front: list[tuple[float, float]] = []
    for mark in sorted(marks, key=lambda m: (m.y, m.x)):
        if not front or mark.x < MORE_EXACT * front[-1][0]:
            front.append((mark.x, mark.y))
    return front
