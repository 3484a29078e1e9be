"""Where things lie: in a checkout around the package, installed in it and in the user's folders."""

from __future__ import annotations

import os
from pathlib import Path

from .errors import InputError

CACHE_CURE = "set CAROM_CACHE to a folder of 200 MB that can be written and run from"
_PACKAGE = Path(__file__).resolve().parent


def checkout() -> Path | None:
    """The clone that this package is a part of; None where it was installed."""
    above = _PACKAGE.parent
    return above if (above / "templates").is_dir() and (above / "bench").is_dir() else None


def sources() -> Path:
    """The folder with the sources that are no Python: CMakeLists.txt, bench/, tests/."""
    return checkout() or _PACKAGE / "sources"


def working_root() -> Path:
    """The folder in which `generated/` lies: the clone, else where the user stands."""
    return checkout() or Path.cwd()


def cache_folder() -> Path:
    """Where builds and figures are kept; CAROM_CACHE names another place.

    In the clone, where that can be written, else in the user's own cache. Raises InputError where
    the user has none.
    """
    if named := os.environ.get("CAROM_CACHE"):
        return Path(named).absolute()
    clone = checkout()
    if clone is not None and _may_write(clone / "build" / "cache"):
        return clone / "build" / "cache"
    base = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if base.is_absolute():  # a relative one is to be ignored, says its specification
        return base / "carom"
    try:
        return Path.home() / ".cache" / "carom"
    except RuntimeError:
        raise InputError(f"there is no home folder (HOME is not set); {CACHE_CURE}") from None


def _may_write(folder: Path) -> bool:
    """May a folder be written, or made?"""
    there = next(place for place in (folder, *folder.parents) if place.exists())
    return os.access(there, os.W_OK | os.X_OK)
