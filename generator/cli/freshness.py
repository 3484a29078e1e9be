"""gen --check and gen --update: generated/ against the sources, without any timing."""

from __future__ import annotations

from pathlib import Path

import click

from .. import api
from .show import session

_MOST_LINES = 20


def show_check(out: Path | None) -> int:
    """0 where every file is as the sources give it, else 1 with the differences and the cure."""
    with session() as told:
        differing = api.check(out, told)
    for difference in differing:
        click.echo(f"{difference.path}: {difference.what}")
        for line in difference.diff[:_MOST_LINES]:
            click.echo(f"  {line}")
    if differing:
        click.echo(f"{len(differing)} files are not what the sources give; run ./gen --update")
        return 1
    click.echo("every file of generated/ is what the sources give")
    return 0


def show_update(out: Path | None) -> int:
    """Make every folder what the sources give, from its selection.json."""
    with session() as told:
        changed = api.update(out, told)
    words = {
        "stray": "removed, no selection.json names it",
        "missing": "made",
        "differs": "made anew",
    }
    for difference in changed:
        click.echo(f"{difference.path}: {words[difference.what]}")
    click.echo(f"{len(changed)} files changed")
    return 0
