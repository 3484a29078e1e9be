"""gen report: one page that shows what a sweep found and why, from what is stored."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .. import api
from ..errors import InputError
from ..files import require_place, write_file
from . import options
from .show import session


@click.command()
@click.option(
    "--out",
    default="report.html",
    show_default=True,
    type=options.PLACE,
    help="an HTML file",
)
@options.STORE
@options.IMPACT
@options.TARGET
@options.SCENE
@options.MODEL
@click.option("--measure", is_flag=True, help="first measure what no sweep keeps (minutes)")
@options.seconds(10.0, "each of the four things that --measure times", least=1)
def report(out: Path, measure: bool, seconds: float, **asked: Any) -> None:
    """Lay out a stored sweep and what was measured as one page; its data goes beside as JSON."""
    if out.suffix != ".html":
        raise InputError(f"{out}: expected the name of an HTML file, as report.html")
    data = out.with_suffix(".json")
    require_place(out)
    require_place(data)
    request = api.ReportRequest(**asked, seconds=seconds if measure else None, out=out)
    with session() as told:
        made = api.report(request, told)
    write_file(data, made.data)
    write_file(out, made.page)
    for what, reason in made.missing.items():
        if what != "published":
            click.echo(f"not known: {what}: {reason}", err=True)
    size = len(made.page.encode()) / 1e6
    click.echo(f"written: {out} ({size:.2f} MB), {data}")
