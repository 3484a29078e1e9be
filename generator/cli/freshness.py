"""gen --check and gen --update: generated/ against the sources, without any timing."""

from __future__ import annotations

from pathlib import Path

import click

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
from .session import ROOT

_MOST_LINES = 20


def _folders(out: Path | None) -> list[Path]:
    root = out or ROOT / "generated"
    found = folders(root)
    if not found:
        raise InputError(f"{root}: holds no selection.json; make one with ./gen --target native")
    return found


def run_check(out: Path | None) -> int:
    """0 where every file is as the sources give it, else 1 with the differences and the cure."""
    found = _folders(out)
    differing = [d for folder in found for d in differences(folder)]
    differing += [Difference(path, "stray") for path in strays_beside(out or ROOT / "generated")]
    for difference in differing:
        click.echo(f"{difference.path}: {difference.what}")
        for line in difference.diff[:_MOST_LINES]:
            click.echo(f"  {line}")
    if differing:
        click.echo(f"{len(differing)} files are not what the sources give; run ./gen --update")
        return 1
    click.echo(f"{len(found)} folders of generated/ are what the sources give")
    return 0


def run_update(out: Path | None) -> int:
    """Make every folder what the sources give, from its selection.json."""
    selections = {folder: checked_selection(folder) for folder in _folders(out)}
    for folder, selection in selections.items():
        assert selection is not None
        files = files_of(selection)
        changed = differences_from(folder, files)
        if changed:
            write_files(folder, files)
        click.echo(f"{folder}: {len(changed)} files changed")
    for path in strays_beside(out or ROOT / "generated"):
        remove(path)
        click.echo(f"{path}: removed, no selection.json names it")
    return 0
