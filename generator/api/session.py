"""What every function works with: where files lie, which tools are there, and who is told."""

from __future__ import annotations

import platform
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from ..errors import InputError
from ..impacts.impact import Impact
from ..places import cache_folder, sources, working_root
from ..targets.host import Host, read_host
from ..targets.target import Target, find_target
from ..toolchain.compilers import compilers_for, find_compilers, missing

if TYPE_CHECKING:  # SymPy and NumPy stand behind these, and a list of targets needs neither
    from ..choice.workbench import Workbench
    from ..evidence.records.evidence import Timings


class Listener(Protocol):
    """Who is told what goes on."""

    def step(self, what: str, done: int, of: int) -> None:
        """`done` of `of` parts of the work that `what` names are done."""

    def note(self, line: str) -> None:
        """What a user should know although the work goes on: one line."""


@dataclass(frozen=True)
class Silent:
    """A listener that shows no steps, and passes notes on where it stands before another."""

    behind: Listener | None = None

    def step(self, what: str, done: int, of: int) -> None:
        """Says nothing."""

    def note(self, line: str) -> None:
        if self.behind is not None:
            self.behind.note(line)


@dataclass(frozen=True)
class Session:
    """Where files lie and who is told: every function of the API takes one.

    `root`: the folder with `generated/` and `timings/`; default: the clone, else where the caller
    stands.
    """

    root: Path = field(default_factory=working_root)
    listener: Listener = field(default_factory=Silent)

    @property
    def generated(self) -> Path:
        return self.root / "generated"

    @property
    def cache(self) -> Path:
        return cache_folder()

    def without_steps(self) -> Session:
        """The same session, of which only the notes are told."""
        return replace(self, listener=Silent(self.listener))

    def timings(self) -> Timings:
        """The records of `timings/`: ours, and those of `root`. Damaged lines are noted."""
        from ..evidence.records.evidence import read_timings

        return read_timings(dict.fromkeys((sources(), self.root)), self.listener.note)

    @contextmanager
    def workbench(
        self,
        target: Target | None = None,
        fresh: bool = False,
        reproducible: bool = False,
        impact: Impact | None = None,
    ) -> Iterator[Workbench]:
        """The tools that emit, compile, verify and time.

        `target`: where it is of another architecture, that one's compilers, and an emulator.
        `impact`: the default one where none is named.
        Raises InputError where there is no compiler, or no place for what it makes.
        """
        from ..choice.workbench import Workbench
        from ..evidence.timing.bench_tool import build_bench_tool
        from ..evidence.timing.emulated import emulated_runner

        self.listener.step("looking for compilers", 0, 1)
        emulated = None
        if target is not None and target.row.arch != platform.machine():
            emulated = emulated_runner(target, self.cache, impact)
        found = compilers_for(target) if emulated and target else find_compilers()
        compilers = {c.code: c for c in found}
        if not compilers:
            raise InputError("no C++ compiler found: apt-get install g++ clang-19")
        if not emulated and (lacking := missing(compilers.values())):
            self.listener.note(f"going on without: {lacking}")
        self.listener.step("building the bench", 0, 1)
        yield Workbench(
            tool=build_bench_tool(self.cache, impact=impact),
            cache=self.cache,
            compilers=compilers,
            progress=self.listener.step,
            fresh=fresh,
            emulated=emulated,
            timings=self.timings(),
            reproducible=reproducible,
        )


def resolve_target(name: str) -> tuple[Target, Host]:
    """The target that a name stands for, and this host; `native` is the host's CPU.

    Raises InputError where there is no such target.
    """
    host = read_host()
    return (host.target if name == "native" else find_target(name)), host
