"""Where things lie: in a checkout around the package, installed in it and in the user's folders."""

from __future__ import annotations

import os
from pathlib import Path

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
    """Where builds and figures are kept; CAROM_CACHE names another place."""
    if named := os.environ.get("CAROM_CACHE"):
        return Path(named).absolute()
    clone = checkout()
    if clone is not None:
        return clone / "build" / "cache"
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "carom"
