"""What a sweep shows while it runs, and what it says at the end."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .interrupts import kept
from .show import show

if TYPE_CHECKING:
    from rich.table import Table

    from ..api.session import Session
    from ..api.sweeping import Swept
    from ..choice.trials import Final, Finalist
    from ..sweep.explore import Observer, Progress
    from ..sweep.sweep import Outcome

_QUIET_SECONDS = 30.0  # between two lines where nobody watches


def clock(seconds: float) -> str:
    whole = max(0, round(seconds))
    return f"{whole // 3600}:{whole // 60 % 60:02}:{whole % 60:02}"


@dataclass
class SweepDisplay:
    """The state of a sweep as rows: done, best so far, time left."""

    started: float
    end: float | None  # of the monotonic clock
    trials: int | None
    done: int = 0
    _before: int = 0
    _contest: str = ""

    def rows(self, progress: Progress) -> list[tuple[str, str]]:
        """Titles and texts."""
        if str(progress.contest) != self._contest:
            self._before, self._contest = self.done, str(progress.contest)
        self.done = self._before + progress.tried
        best = "none yet"
        if progress.best_ratio is not None:
            from ..api.sweeping import baseline_of

            best = f"{progress.best_ratio:.4f} of {baseline_of(progress.contest)}: {progress.best}"
        of = "" if self.trials is None else f" of {self.trials}"
        done = f"{self.done}{of} trials, {progress.reused} taken from the store, "
        return [
            ("contest", self._contest),
            ("doing", progress.doing),
            ("done", done + f"{progress.rejected} rejected here"),
            ("best so far", best),
            ("time", f"{clock(self._now())}{self._left()}"),
        ]

    def _now(self) -> float:
        return time.monotonic() - self.started

    def _left(self) -> str:
        left = [] if self.end is None else [self.end - time.monotonic()]
        if self.trials is not None and self.done:
            left.append(self._now() / self.done * (self.trials - self.done))
        return f", {clock(min(left))} left at most" if left else ", no limit"


@contextmanager
def watched(
    session: Session, minutes: float | None, trials: int | None = None
) -> Iterator[Observer]:
    """An observer that shows rows on a terminal, elsewhere a line now and then; Ctrl-C is kept."""
    from rich.console import Console
    from rich.live import Live

    started = time.monotonic()
    end = None if minutes is None else started + 60 * minutes
    display, console = SweepDisplay(started, end, trials), Console(stderr=True)
    if console.is_terminal:
        with Live(console=console, refresh_per_second=4, transient=True) as live:

            def draw(progress: Progress) -> None:
                live.update(_table(display.rows(progress)))

            with kept(draw) as shown:
                yield shown
        return
    last_time, last_contest = float("-inf"), ""

    def line(progress: Progress) -> None:
        nonlocal last_time, last_contest
        rows = dict(display.rows(progress))
        now = time.monotonic()
        new = rows["contest"] != last_contest
        if new or now - last_time >= _QUIET_SECONDS:
            last_time, last_contest = now, rows["contest"]
            said = [rows[key] for key in ("time", "contest", "doing", "done", "best so far")]
            session.listener.note("; ".join(said))

    with kept(line) as observe:
        yield observe


def _table(rows: Sequence[tuple[str, str]]) -> Table:
    from rich.table import Table

    table = Table(show_header=False, show_edge=False, box=None)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for title, text in rows:
        table.add_row(title, text)
    return table


def say_outcomes(swept: Swept) -> None:
    """What was chosen in each contest, what ties with it, what was rejected, what was not used."""
    for outcome in swept.outcomes:
        exploration, final = outcome.exploration, outcome.final
        counts = ", ".join(f"{n} {why}" for why, n in sorted(exploration.rejected.items()))
        end = "nothing near the best is left" if exploration.complete else "the budget was used up"
        click.echo(
            f"\n{exploration.contest}: {len(exploration.entries)} variants, "
            f"{exploration.tried} of them tried now; {end}; rejected: {counts or 'none'}"
        )
        if final is None:
            click.echo(f"nothing {'was tried' if exploration.untried else 'passed'}: no choice")
        else:
            say_final(final)
    for why, count in swept.unused.items():
        click.echo(f"stored, not used: {count} trials: {why}")
    click.echo(f"trials: {swept.made} made, {swept.reused} taken from the store")
    if swept.written is not None:
        click.echo(f"written: {swept.written}")
    click.echo(f"store: {swept.store}")


def say_best(outcomes: Sequence[Outcome]) -> None:
    """A line for each contest."""
    for outcome in outcomes:
        final = outcome.final
        best = f"{final.fastest} is the fastest" if final else "no kernel was timed to the end"
        click.echo(f"{outcome.exploration.contest}: {best}")


def say_stopped(store: Path) -> None:
    """After Ctrl-C."""
    click.echo(
        f"carom: stopped; all that was measured is kept in {store}, and the same command goes on "
        "from there",
        err=True,
    )


def say_final(final: Final) -> None:
    """The finalists that tie with the fastest or lie near it, the choice marked."""
    ties = final.ties
    shown = [r for i, r in enumerate(final.finalists) if i < 5 or r.subject.name in ties]
    chosen = final.row(final.chosen)
    if chosen not in shown:
        shown.append(chosen)
    low, high = final.control
    title = f"{len(final.finalists)} kernels, {final.rounds} rounds, A/A {low:.4f} to {high:.4f}"
    show({title: [_row(row, final) for row in shown]}, False)
    click.echo(f"chosen: {final.chosen}; ties with the fastest: {len(ties)}")


def say_verified(final: Final) -> bool:
    """The re-timing of a choice; is it still not clearly beaten?"""
    from ..sweep.finals import beaten_by

    say_final(final)
    beaten = beaten_by(final)
    most = max((b.gain for b in beaten), default=1.0)
    clear = [b for b in beaten if b.clear]
    text = f"the choice holds: none is faster by more than {100 * (most - 1):.1f} %"
    if clear:
        text = f"the choice is beaten by {100 * (clear[0].gain - 1):.1f} %: {clear[0].name}"
    click.echo(f"{final.contest}: {text}")
    return not clear


def _row(row: Finalist, final: Final) -> dict[str, object]:
    from ..api.sweeping import baseline_of

    low, high = row.to_fastest_ci
    chosen = row.subject.name == final.chosen
    return {
        "ns": round(row.times.ns),
        f"of {baseline_of(final.contest)}": f"{row.times.ratio:.4f}",
        "to fastest (95 %)": f"{row.to_fastest:.4f} ({low:.4f}-{high:.4f})",
        "error": None if row.max_rel_error is None else f"{row.max_rel_error:.1e}",
        "": "chosen" if chosen else "tie" if row.tie else "",
        "kernel": row.subject.name,
    }
