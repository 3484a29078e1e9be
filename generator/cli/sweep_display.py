"""What a sweep shows while it runs, and what it says at the end."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from rich.console import Console
from rich.live import Live
from rich.table import Table

from ..sweep.explore import Observer, Progress
from ..sweep.finals import beaten_by, row_of
from ..sweep.ledger import Ledger
from ..sweep.record import Final, Finalist
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
        if progress.contest.name != self._contest:
            self._before, self._contest = self.done, progress.contest.name
        self.done = self._before + progress.tried
        best = "none yet"
        if progress.best_ratio is not None:
            best = f"{progress.best_ratio:.4f} of paper-initial: {progress.best}"
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
def displayed(display: SweepDisplay, console: Console) -> Iterator[Observer]:
    """Rows that are drawn anew on a terminal; elsewhere a line now and then."""
    if console.is_terminal:
        with Live(console=console, refresh_per_second=4, transient=True) as live:
            yield lambda progress: live.update(_table(display.rows(progress)))
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
            text = "carom: " + "; ".join(said)
            console.print(text, highlight=False, markup=False, soft_wrap=True)

    yield line


def _table(rows: Sequence[tuple[str, str]]) -> Table:
    table = Table(show_header=False, show_edge=False, box=None)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for title, text in rows:
        table.add_row(title, text)
    return table


def say_outcomes(console: Console, outcomes: Sequence[Outcome], ledger: Ledger) -> None:
    """What was chosen in each contest, what ties with it, what was rejected, what was not used."""

    def say(text: str) -> None:
        console.print(text, highlight=False, markup=False, soft_wrap=True)

    for outcome in outcomes:
        exploration, final = outcome.exploration, outcome.final
        counts = ", ".join(f"{n} {why}" for why, n in sorted(exploration.rejected.items()))
        end = "nothing near the best is left" if exploration.complete else "the budget was used up"
        say(
            f"\n{exploration.contest.name}: {len(exploration.entries)} variants, "
            f"{exploration.tried} of them tried now; {end}; rejected: {counts or 'none'}"
        )
        if final is None:
            say(f"nothing {'was tried' if exploration.untried else 'passed'}: no choice")
        else:
            say_final(console, final)
    for why, count in sorted(ledger.unused.items()):
        say(f"stored, not used: {count} trials: {why}")
    say(f"trials: {ledger.made} made, {ledger.reused} taken from the store")


def say_final(console: Console, final: Final) -> None:
    """The finalists that tie with the fastest or lie near it, the choice marked."""
    table = Table(show_edge=False, pad_edge=False, collapse_padding=True)
    table.add_column("kernel", overflow="fold", ratio=1)
    for title in ("ns", "of paper-\ninitial", "to fastest\n(95 %)", "error", ""):
        table.add_column(title, justify="right", no_wrap=True)
    ties = final.ties
    shown = [r for i, r in enumerate(final.finalists) if i < 5 or r.subject.name in ties]
    chosen = row_of(final, final.chosen)
    if chosen not in shown:
        shown.append(chosen)
    for row in shown:
        table.add_row(_short(row.subject.name), *_figures(row), _mark(row, final))
    console.print(table)
    low, high = final.control
    console.print(
        f"{len(final.finalists)} kernels, {final.rounds} rounds, A/A {low:.4f} to {high:.4f}; "
        f"chosen: {final.chosen}; ties with the fastest: {len(ties)}",
        highlight=False,
        soft_wrap=True,
    )


def say_verified(console: Console, final: Final) -> bool:
    """The re-timing of a choice; is it still not clearly beaten?"""
    say_final(console, final)
    beaten = beaten_by(final)
    most = max((b.gain for b in beaten), default=1.0)
    clear = [b for b in beaten if b.clear]
    text = f"the choice holds: none is faster by more than {100 * (most - 1):.1f} %"
    if clear:
        text = f"the choice is beaten by {100 * (clear[0].gain - 1):.1f} %: {clear[0].name}"
    console.print(f"{final.contest}: {text}", highlight=False, soft_wrap=True)
    return not clear


def _short(name: str) -> str:
    """A kernel's name without what all of its contest share."""
    return name.split(".", 3)[3]


def _figures(row: Finalist) -> list[str]:
    low, high = row.to_fastest_ci
    error = "-" if row.max_rel_error is None else f"{row.max_rel_error:.1e}"
    ratio = f"{row.times.ratio:.4f}"
    return [f"{row.times.ns:.0f}", ratio, f"{row.to_fastest:.4f} ({low:.4f}-{high:.4f})", error]


def _mark(row: Finalist, final: Final) -> str:
    if row.subject.name == final.chosen:
        return "chosen"
    return "tie" if row.tie else ""
