"""Branch and cache misses of a kernel as valgrind's callgrind simulates them.

Its branch predictor and caches are models of its own, not those of any CPU. It knows no AVX-512, so
a kernel is simulated as built for a target without it.
"""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import KernelError
from ...toolchain.process import run
from ..verification.errors import Array

TIMEOUT = 300.0
_NAME = re.compile(r"\((\d+)\)(?: (.*))?")
_EVENTS = {  # ours: callgrind's, added up
    "instructions": ("Ir",),
    "branches": ("Bc", "Bi"),
    "branch_misses": ("Bcm", "Bim"),
    "l1_data_misses": ("D1mr", "D1mw"),
    "l1_instruction_misses": ("I1mr",),
    "last_level_misses": ("ILmr", "DLmr", "DLmw"),
}


@dataclass(frozen=True)
class Misses:
    """Per collision, of the kernel's own code."""

    events: Mapping[str, float]
    version: str
    cases: int


def simulate_misses(bench: Path, library: Path, cases: Array) -> Misses:
    """Run `carom_bench run` on cases (rows of 24) under callgrind. Raises KernelError."""
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        raise KernelError("no valgrind found (apt-get install valgrind)")
    version = run([valgrind, "--version"], 20).output.strip()
    with tempfile.TemporaryDirectory() as name:
        rows, out, profile = (Path(name, part) for part in ("rows", "out", "profile"))
        np.ascontiguousarray(cases, dtype=np.float64).tofile(rows)
        tool = ["--tool=callgrind", "--cache-sim=yes", "--branch-sim=yes"]
        kernel = ["run", "--kernel", str(library), "--cases", str(rows), "--out", str(out)]
        command = [valgrind, *tool, f"--callgrind-out-file={profile}", str(bench), *kernel]
        done = run(command, TIMEOUT)
        if done.code != 0 or not profile.is_file():
            raise KernelError(f"valgrind: {_reason(done.errors, done.code)}")
        totals = own_costs(profile.read_text("utf-8").splitlines(), library)
    events = {
        ours: sum(totals.get(event, 0) for event in theirs) / len(cases)
        for ours, theirs in _EVENTS.items()
    }
    return Misses(events, version, len(cases))


def _reason(errors: str, code: int) -> str:
    """What valgrind says when it ends early, without its own banner."""
    told = [re.sub(r"^==\d+==\s*", "", line).strip() for line in errors.splitlines()]
    wanted = ("unhandled instruction", "terminating", "error", "fatal")
    return next((t for t in told for w in wanted if w in t.lower()), f"exit status {code}")


def own_costs(lines: Iterable[str], library: Path) -> dict[str, int]:
    """Events counted in a library's own code, calls into others left out."""
    names: dict[str, str] = {}
    events: list[str] = []
    totals: dict[str, int] = {}
    inside = skip = False
    for line in lines:
        if line.startswith("events:"):
            events = line.split()[1:]
            totals = dict.fromkeys(events, 0)
        elif line.startswith("ob="):
            number, text = _NAME.match(line[3:]).groups()  # type: ignore[union-attr]
            if text:
                names[number] = text
            inside = Path(names[number]) == library
        elif line.startswith("cob=") and (match := _NAME.match(line[4:])) is not None and match[2]:
            names[match[1]] = match[2]
        elif line.startswith("calls="):
            skip = True  # the next line is what the callee cost
        elif line[:1].isdigit() or line[:1] in "+-*":
            if inside and not skip and line:
                for event, cost in zip(events, line.split()[1:], strict=False):
                    totals[event] += int(cost)
            skip = False
    return totals
