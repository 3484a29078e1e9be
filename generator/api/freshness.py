"""`generated/` against the sources, without any timing."""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from ..choice.folder import (
    Difference,
    checked_selection,
    differences,
    differences_from,
    files_of,
    folders,
    remove,
    strays_beside,
    write_files,
)
from ..errors import InputError
from .session import Session


def check(out: Path | None = None, session: Session | None = None) -> tuple[Difference, ...]:
    """Every file that is not as the sources give it; none where `generated/`, or `out`, is fresh.

    Raises InputError where there is nothing to check, or a selection.json cannot be read.
    """
    root = out or (session or Session()).generated
    differing = [d for each in _all_differences(generated_folders(root)) for d in each]
    return (*differing, *(Difference(path, "stray") for path in strays_beside(root)))


def _all_differences(found: list[Path]) -> list[list[Difference]]:
    """Of each folder; of several in processes side by side."""
    if len(found) == 1:
        return [differences(found[0])]
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(differences, found))


def update(out: Path | None = None, session: Session | None = None) -> tuple[Difference, ...]:
    """Make every folder what the sources give, from its selection.json; what was not so before.

    Raises InputError as `check` does, before anything is written.
    """
    root = out or (session or Session()).generated
    selections = [(folder, checked_selection(folder)) for folder in generated_folders(root)]
    changed: list[Difference] = []
    for folder, selection in selections:
        if selection is None:
            continue  # removed since it was listed
        files = files_of(selection)
        if differing := differences_from(folder, files):
            write_files(folder, files)
        changed += differing
    strays = strays_beside(root)
    for path in strays:
        remove(path)
    return (*changed, *(Difference(path, "stray") for path in strays))


def generated_folders(root: Path) -> list[Path]:
    """The folders that a selection.json stands in. Raises InputError where there is none."""
    found = folders(root)
    if not found:
        raise InputError(f"{root}: holds no selection.json; make one with ./gen --target native")
    return found
