"""gen collide: run collisions of a CSV file through the chosen kernel."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .. import api
from ..files import is_stdout, require_place, write_file
from . import options
from .show import session


@click.command()
@click.option("--cases", required=True, type=options.PLACE, help="CSV of cases")
@click.option("--out", required=True, type=options.PLACE, help="CSV to write")
@options.IMPACT
@options.MODEL
@options.TARGET
@options.STEPS
@options.MAX_ERROR
@options.BATCH
def collide(cases: Path, out: Path, **asked: Any) -> None:
    """Collide the cases of a CSV file."""
    request = api.Request(**asked)
    request.resolved()
    table = api.read_cases(cases, request.impact)
    require_place(out)
    with session() as told:
        found = api.collide(table.rows, request, told)
    write_file(out, api.outcome_text(table.ids, found.outcomes, request.impact))
    text = f"{len(table.ids)} cases, {found.collided} collided, by {found.kernel}; written: {out}"
    click.echo(text, err=is_stdout(out))
