"""kill -9 at any moment: nothing lost, nothing twice, no broken store, and the next run goes on."""

from __future__ import annotations

import os
import random
import signal
import sqlite3
import subprocess
import sys
import time
from collections import Counter
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import pytest

from generator.choice.trials import Trial
from generator.evidence.records.code import digest
from generator.registry.names import name_of
from generator.sweep.space import Space
from generator.sweep.store import read_only
from generator.targets.host import read_host
from tests.support.kernels import ROOT
from tests.support.sweep_victim import ASKED

MADE_UP = [sys.executable, "-P", "-m", "tests.support.sweep_victim"]
ONLY = ("compiler=gcc", "flags=strict", "simd=scalar", "store=named", "fma=fma", "branch=chosen")
REAL = [sys.executable, "-P", "-m", "generator", "sweep", "--exhaustive", "--steps", "200"]
REAL += ["--call", "scalar"]


@dataclass(frozen=True)
class Life:
    """One run: how it ended, and what it had said until then."""

    code: int
    lines: tuple[str, ...]


def run_and_kill(command: list[str], seconds: float | None) -> Life:
    """Kill a run so many seconds after it said something; None lets it live."""
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert process.stdout is not None
    first = process.stdout.readline()
    if seconds is not None:
        time.sleep(seconds)
        process.send_signal(signal.SIGKILL)
    rest = process.stdout.read()
    whole = (first + rest).split("\n")[:-1]  # the last one may be cut
    return Life(process.wait(), tuple(whole))


def trials_of(path: Path) -> dict[str, Trial]:
    """Trials by id, of a store that is whole: SQLite says so, ids are right, no key is twice."""
    with closing(sqlite3.connect(path)) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    with read_only(path) as store:
        records = list(store.records())
    for record in records:
        assert record.id == digest(record.model_dump(mode="json", exclude={"id"}))
    trials = {record.id: record for record in records if isinstance(record, Trial)}
    twice = [key for key, n in Counter(t.key for t in trials.values()).items() if n > 1]
    assert twice == []
    return trials


def kill_until(command: list[str], path: Path, kills: int, longest: float) -> int:
    """Kill runs at random moments, then let one end; how many kills hit a run that was busy."""
    moments, known, hit = random.Random(kills), set[str](), 0
    for number in range(kills):
        life = run_and_kill(command, moments.uniform(0, longest))
        told = {line.split()[1] for line in life.lines if line.startswith("kept ")}
        now = set(trials_of(path))
        with read_only(path) as store:
            assert told <= {record.id for record in store.records()}, "told to be kept, and gone"
        assert known <= now, "a record of an earlier run is gone"
        print(f"kill {number + 1}: {len(now)} trials, {len(now - known)} of this run; {life.code}")
        hit += life.code == -signal.SIGKILL
        known = now
    last = run_and_kill(command, None)
    assert last.code == 0, "\n".join(last.lines[-5:])
    assert known <= set(trials_of(path))
    return hit


def tried(path: Path) -> Counter[str]:
    """How often each variant was tried on the lowest rung."""
    lowest = [t for t in trials_of(path).values() if t.rung == 0 and t.depends is not None]
    return Counter(t.subject.name for t in lowest)


def test_a_sweep_that_is_killed_again_and_again_tries_each_variant_once(tmp_path: Path) -> None:
    path = tmp_path / "s.sqlite"
    hit = kill_until([*MADE_UP, str(path)], path, 8, longest=0.8)
    space = Space(ASKED.contests[0], ASKED.target, ("gcc",), (1,), ASKED.only)
    legal = {name_of(v) for v in space.everything()}
    print(f"{hit} runs killed; {len(legal)} variants, each tried once")
    assert hit >= 6
    assert tried(path) == Counter(legal)


def real_kills(path: Path, kills: int, longest: float, *only: str) -> int:
    if not read_host().exact:
        pytest.skip("this CPU is none of the targets: nothing to sweep for")
    options = [word for axis in (*ONLY, *only) for word in ("--only", axis)]
    command = [*REAL, *options, "--store", str(path)]
    hit = kill_until(command, path, kills, longest)
    counts = tried(path)
    print(
        f"{hit} of {kills} kills hit a run that was busy; {len(counts)} variants, each tried once"
    )
    assert set(counts.values()) == {1}
    again = run_and_kill(command, None)
    [line] = [line for line in again.lines if line.startswith("trials: ")]
    assert line.startswith("trials: 0 made, ")
    return hit


def test_the_command_itself_may_be_killed(tmp_path: Path) -> None:
    few = ("rsqrt=inv,est1", "reuse=precompute", "state=reduced", "order=paper", "roots=early")
    assert real_kills(tmp_path / "s.sqlite", 2, 5.0, *few) >= 1


@pytest.mark.long
def test_the_command_itself_may_be_killed_50_times(tmp_path: Path) -> None:
    assert real_kills(tmp_path / "s.sqlite", 50, 20.0) >= 45
