"""What the main job prints: the choices and the front on one screen, or every candidate."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import click

from .. import api
from .show import session, show, three_digits

if TYPE_CHECKING:
    from ..api.generation import Decision, Generated, Row

LINES, COLUMNS = 40, 80  # of the summary
_ROWS = 12  # of the front
_LEAST = 8  # lines that the front has at least
_NAME = 48  # columns of what is chosen, before its figures
_INDENT = " " * 4


def show_generated(everything: bool, **asked: Any) -> None:
    """Everything that `./gen --target T` does; `everything` prints every candidate and flip."""
    request = api.GenerateRequest(**asked)
    with session() as told:
        made = api.generate(request, told)
    click.echo("\n".join(summary(made)))
    if everything:
        for contest in made.decisions:
            _show_all(made, contest)


def summary(made: Generated) -> list[str]:
    """What was chosen in each contest, then the front of speed against error.

    Many contests may leave no room for recipes: a line then says where these are.
    """
    choices = _chosen(made, recipes=True)
    if len(choices) > LINES - _LEAST:
        choices = [*_chosen(made, recipes=False), "recipes: by --all, and on top of each file"]
    lines = [*choices, "", "front of speed against error (--all prints every candidate and flip):"]
    fronts = [(c, row) for fixed in (False, True) for c, row in _front(made, fixed)]
    before, shown = "", 0
    for contest, row in fronts:
        title = [] if before == contest.title else [contest.title]
        block = [*title, *_front_row(row)]
        if shown == _ROWS or len(lines) + len(block) > LINES:
            break
        lines, shown, before = lines + block, shown + 1, contest.title
    return lines


def _chosen(made: Generated, recipes: bool) -> list[str]:
    lines = [*_head(made)]
    for fixed in (True, False):
        own = [c for c in made.decisions if c.fixed is fixed]
        own.sort(key=lambda c: c.entry.width > 1)  # models side by side, which often agree
        lines += _choices(own, fixed, recipes)
    return lines


def _head(made: Generated) -> Iterator[str]:
    yield from _wrapped(f"scene {made.scene}; {made.decisions[0].choice.evidence}", "")
    if made.emulator:
        yield from _wrapped(
            f"{made.target.name} is of another architecture: run under {made.emulator}, and no "
            "time is known of it",
            "",
        )
    yield from _wrapped(f"written: {made.folder}/selection.json, carom.h, and these kernels", "")


def _choices(contests: Sequence[Decision], fixed: bool, recipes: bool) -> Iterator[str]:
    """A line of figures for each contest; kernels side by side that share a recipe name it once."""
    if not contests:
        return
    against = "the scheme" if fixed else "exact solution"
    yield ""
    yield f"{'':{_NAME}}{'times as fast':>15}{'error against':>17}"
    over = f"chosen; errors over {contests[0].over}"
    head = f"{'fixed steps' if fixed else 'exact kernels'}: {over}"
    first = f"as {contests[0].baseline_name}"
    yield f"{head:{_NAME}}{first:>16}{against:>16}"
    after = [contest.recipe for contest in contests[1:]]
    for contest, following in zip(contests, [*after, ""], strict=True):
        entry = contest.entry
        ratio = entry.ratio_to_baseline
        times = "-" if not ratio else three_digits(1 / ratio)
        error = "-" if entry.max_rel_error is None else f"{entry.max_rel_error:.2e}"
        short = len(entry.file) < _NAME
        name = entry.file if short else contest.title
        yield f"{name:{_NAME}}{times:>15}{error:>17}"
        if recipes and contest.recipe != following:
            yield from _wrapped(contest.recipe, _INDENT)
        if recipes and not short:
            yield from _wrapped(entry.file, _INDENT)
        if entry.search.startswith("OVER"):
            yield from _wrapped(f"search for errors: {entry.search.split('; case')[0]}", _INDENT)


def _front(made: Generated, fixed: bool) -> Iterator[tuple[Decision, Row]]:
    """The rows of each contest that no other beats in both, in turn until there are enough."""
    contests = [c for c in made.decisions if c.fixed is fixed]
    share = max(1, _ROWS // max(1, len(made.decisions)))
    for contest in contests:
        for row in contest.front()[:share]:
            yield contest, row


def _front_row(row: Row) -> list[str]:
    times = "-" if row.ratio is None else three_digits(1 / row.ratio)
    figures = f"{times:>9} times {row.error or 0.0:9.2e}  "
    return _wrapped(row.label, " " * len(figures), figures)


def _wrapped(text: str, indent: str, first: str | None = None) -> list[str]:
    """A text in lines of at most 80 columns; what is longer than a line goes on in the next."""
    head = indent if first is None else first
    return textwrap.wrap(
        text, COLUMNS, initial_indent=head, subsequent_indent=indent, break_on_hyphens=False
    )


def _show_all(made: Generated, contest: Decision) -> None:
    against = "the same scheme" if contest.fixed else "the exact solution"
    title = f"\n{contest.title}: errors against {against}, over {contest.over}"
    first = contest.baseline_name
    show({title: [_row(row, first) for row in contest.rows()]}, False)
    for name, why in contest.rejected.items():
        click.echo(f"rejected {name}: {why}")
    for line in _footnotes(made, contest):
        click.echo(line)


def _row(row: Row, baseline: str) -> dict[str, object]:
    low, high = row.interval or (None, None)
    return {
        "ns": None if row.ns is None else round(row.ns),
        "latency ns": None if row.latency is None else round(row.latency),
        "cycles": None if row.cycles is None else round(row.cycles),
        f"of {baseline}": None if row.ratio is None else three_digits(row.ratio),
        "95 %": None if not low or not high else f"{three_digits(low)}-{three_digits(high)}",
        "error": None if row.error is None else f"{row.error:.1e}",
        "": row.mark,
        "kernel": row.label,
    }


def _footnotes(made: Generated, contest: Decision) -> Iterator[str]:
    choice, chosen = contest.choice, contest.choice.chosen
    for verdict, head in ((chosen.verdict, ""), (chosen.pooltool, "against pooltool's figures: ")):
        if verdict is not None:
            yield f"{head}verified on {verdict.cases} cases; the chosen kernel: {verdict.reason}"
            yield from (f"  flip by a step: {contest.labels[flip]}" for flip in verdict.flips)
    if contest.baseline.variant.scene != made.scene:
        first = contest.baseline_name
        yield (
            f"scene {made.scene} has no fixed-step kernels: {first} is that of scene "
            f"{contest.baseline.variant.scene}"
        )
    if (model := contest.model) is not None:
        yield (
            f"cycles: of {model.cases} cases' instructions, executed on {made.host.target.name} "
            f"and replayed by llvm-mca for {model.cpu}: a model's figure, not a time"
        )
    yield f"grounds: {choice.evidence}"
    if choice.sought is not None:
        yield f"search for errors: {choice.sought} (gen challenge searches longer)"
    yield from contest.compiler_notes
    if made.reused:
        yield f"reused from earlier runs: {made.reused} (--fresh verifies and times anew)"
    yield f"chosen: {chosen.name}; ties with it: {len(choice.ties) - 1}"
