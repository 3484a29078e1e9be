"""What `gen challenge` prints."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ..api.challenging import Challenged
from ..evidence.challenge.kept import csv_header, csv_row, hexfloats
from ..evidence.challenge.place import search_of
from ..evidence.challenge.search import Finding
from ..evidence.verification.errors import Array

_WORDS = {
    "error": "off by {:.3g} of the budget",
    "refused": "refused though valid",
    "steep": "off by {:.3g} of the limit, but the exact result is steep: not counted",
    "floor": "off by {:.3g} of the budget, under the doubles' floor: not counted",
    "jump": "neighbouring inputs' results jump by {:.3g} of a tenth of the budget",
    "energy": "kinetic energy grows by {:.3g} of the budget",
    "symmetry": "an image's result differs by {:.3g} of the budget",
    "slow": "{:.0f} evaluations",
}


def lines(searched: Challenged) -> Iterator[str]:
    """A table of the hunts, what is over or apart, and the worst case to the last bit."""
    subject, found = searched.subject, searched.results
    within, errors = subject.within, found[0]
    head = f"{searched.kernel}{' (batches)' * subject.batch}"
    yield f"{head}: envelope {within.extent}, seed {searched.seed}"
    ranges = within.ranges.items()
    yield "ranges: " + ", ".join(f"{key} {low:g} to {high:g}" for key, (low, high) in ranges)
    words, names = search_of(subject.tool.impact).words, subject.tool.columns.case
    evaluations, seconds = sum(r.evaluations for r in found), sum(r.seconds for r in found)
    yield f"{evaluations} evaluations, {evaluations / seconds:.0f} a second"
    for result in found:
        verdict = "" if result.hunt == "slow" else ("" if result.held else "OVER: ")
        yield f"  {result.hunt:9}{result.evaluations:9}  {verdict}{_words(result.worst, words)}"
        for finding in (*result.over[1:], *result.apart):
            yield f"  {'':18}  {_words(finding, words)}"
    over = "OVER" if not errors.held else "within the budget"
    yield f"worst error over {subject.budget:g}: {errors.worst.over:.4g} ({over})"
    yield from (csv_header(names), csv_row("found_by_search", errors.worst.case))
    yield hexfloats(errors.worst.case, names)


def _words(finding: Finding, words: Callable[[Array], str]) -> str:
    where = words(finding.case)
    moved = f", a rounding moves it by {finding.moved:.1e}" if finding.moved else ""
    return f"{_WORDS[finding.kind].format(finding.over)} ({where}{moved})"


def brief_line(searched: Challenged) -> str:
    """A row of a table: model, budget, calls or batches, evaluations, the worst of each hunt."""
    subject, found = searched.subject, searched.results
    errors = found[0]
    apart = f"{len(errors.apart)} apart" if errors.apart else ""
    hunts = " ".join(f"{r.hunt} {r.worst.over:.3g}{'' if r.held else '!'}" for r in found)
    by = "batch" if subject.batch else "call"
    head = f"{subject.within.model:13}{subject.budget:<7.0e}{by:6}"
    return f"{head}{sum(r.evaluations for r in found):9}  {hunts} {apart}  {searched.kernel}"
