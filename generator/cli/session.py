"""What every verb needs: the folders, the tools, a progress display."""

from __future__ import annotations

import platform
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from ..choice.workbench import Workbench
from ..errors import InputError
from ..evidence.records.evidence import read_timings
from ..evidence.timing.bench_tool import build_bench_tool
from ..evidence.timing.emulated import emulated_runner
from ..places import cache_folder, sources, working_root
from ..targets.host import Host, read_host
from ..targets.target import Target, find_target
from ..toolchain.compilers import compilers_for, find_compilers, missing

ROOT = working_root()  # `generated/` is in it
RECORDED = tuple(dict.fromkeys((sources(), ROOT)))  # `timings/` is in them: ours, and the user's


def resolve_target(name: str) -> tuple[Target, Host]:
    """The target that a name stands for; `native` is this host's CPU."""
    host = read_host()
    return (host.target if name == "native" else find_target(name)), host


@contextmanager
def workbench(
    quiet: bool = False, fresh: bool = False, target: Target | None = None
) -> Iterator[Workbench]:
    """A workbench whose progress shows on standard error what it is doing.

    `target`: where it is of another architecture, that one's compilers, and an emulator.
    """
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}", table_column=None),
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True, disable=quiet) as bars:
        task = bars.add_task("looking for compilers", total=None)
        last = {"what": ""}

        def show(what: str, done: int, of: int) -> None:
            head = what.split(" (")[0]
            if not console.is_terminal and head != last["what"] and not quiet:
                console.print(f"carom: {what}", highlight=False)
            last["what"] = head
            bars.update(task, description=what, completed=done, total=of)

        emulated = None
        if target is not None and target.row.arch != platform.machine():
            emulated = emulated_runner(target, cache_folder())
        found = compilers_for(target) if emulated and target else find_compilers()
        compilers = {c.code: c for c in found}
        if not compilers:
            raise InputError("no C++ compiler found: apt-get install g++ clang-19")
        if not emulated and (lacking := missing(compilers.values())):
            console.print(f"carom: going on without: {lacking}", highlight=False)
        show("building the bench", 0, 1)
        tool = build_bench_tool(cache_folder())
        timings = read_timings(
            RECORDED, lambda line: console.print(f"carom: {line}", highlight=False)
        )
        yield Workbench(tool, cache_folder(), compilers, show, fresh, emulated, timings)
