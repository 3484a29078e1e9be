"""Machines that tests may believe to be on: what /proc/cpuinfo says there (tests/data/cpuinfo).

Nothing but a test can fake a host: a time that is taken is always this machine's.
"""

from __future__ import annotations

import platform
from pathlib import Path

import pytest

from generator.targets import host
from generator.targets.target import find_target

FOLDER = Path(__file__).parents[1] / "data" / "cpuinfo"


def names() -> list[str]:
    return sorted(path.stem for path in FOLDER.glob("*.txt"))


def cpuinfo_of(name: str) -> Path:
    return FOLDER / f"{name}.txt"


def machine_of(name: str) -> str:
    """As `uname -m` says it there."""
    return "x86_64" if "vendor_id" in cpuinfo_of(name).read_text("utf-8") else "aarch64"


def believe(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Make this process believe that it is on that machine."""
    monkeypatch.setattr(host, "CPUINFO", cpuinfo_of(name))
    monkeypatch.setattr(platform, "machine", lambda: machine_of(name))


def skip_unless_runs(*targets: str) -> None:
    """Skip a test that runs code of its own choice where this CPU cannot."""
    for name in targets:
        if not host.read_host().runs(find_target(name)):
            pytest.skip(f"this CPU runs no code for {name}")
