"""carom as pip installs it, in a folder of build/; made anew where a source changed."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from filelock import FileLock

from generator.places import sources

ROOT = sources()
BUILD = ROOT / "build" / "python"
# Kernels round alike at any level (tests/kernels builds them at -O3), and this takes less time.
LEVEL = "CMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG"
_PARTS = ("generator", "templates", "python", "bench", "tests/oracle", "tests/data")
_FILES = ("CMakeLists.txt", "pyproject.toml", "requirements.lock")


def _hash() -> str:
    digest = hashlib.sha256(sys.version.encode())
    found = [p for part in _PARTS for p in (ROOT / part).rglob("*") if p.is_file()]
    for path in sorted([*found, *(ROOT / name for name in _FILES)]):
        if path.suffix != ".pyc":
            digest.update(str(path.relative_to(ROOT)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def run(command: Sequence[object], timeout: float = 1500.0, **environment: str) -> str:
    """What a command prints; an AssertionError with its end where it fails."""
    done = subprocess.run(
        [str(word) for word in command],
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=timeout,
        check=False,
    )
    assert done.returncode == 0, f"{command}: exit status {done.returncode}\n{done.stdout[-3000:]}"
    return done.stdout


@cache
def wheel() -> Path:
    """The wheel of the sources as they are."""
    folder = BUILD / f"wheel-{_hash()}"
    BUILD.mkdir(parents=True, exist_ok=True)
    with FileLock(BUILD / "lock"):
        if not folder.is_dir():
            scratch = BUILD / "scratch"
            shutil.rmtree(scratch, ignore_errors=True)
            # Not -C, which pip 23.0 does not know.
            options = ("--no-build-isolation", "--no-deps", "--no-index", "-w", scratch)
            pip = (sys.executable, "-m", "pip", "wheel", ROOT, *options)
            settings = (f"build-dir={BUILD / 'cmake'}", f"cmake.define.{LEVEL}")
            run([*pip, *(f"--config-settings={each}" for each in settings)], timeout=1500.0)
            for old in BUILD.glob("wheel-*"):
                shutil.rmtree(old)
            scratch.rename(folder)
    return next(folder.glob("*.whl"))


@cache
def site() -> Path:
    """A folder with what pip installs from the wheel: carom, generator, bin/gen."""
    made = wheel()
    folder = made.parent / "site"
    with FileLock(BUILD / "lock"):
        if not folder.is_dir():
            scratch = made.parent / "site.tmp"
            pip = (sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-index")
            run([*pip, "--target", scratch, made])
            scratch.rename(folder)
    return folder


def carom():  # type: ignore[no-untyped-def]
    """The installed module `carom`; `generator` stays the checkout's."""
    import importlib

    if str(site()) not in sys.path:
        sys.path.append(str(site()))
    return importlib.import_module("carom")
