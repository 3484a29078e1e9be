"""gen plot: the pictures of the documentation, measured or computed here."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .. import api
from ..errors import InputError
from ..files import require_place, write_file
from ..impacts import DEFAULT
from . import options
from .show import rows_of, session, show


@click.command()
@click.option("--out", required=True, type=options.PLACE, help="an SVG file")
@click.option("--models", is_flag=True, help="how far the contact models differ, instead of times")
@click.option("--from", "source", type=options.PLACE, help="draw this JSON again")
@options.IMPACT
@options.TARGET
@options.SCENE
@options.MODEL
@options.seconds(60.0, "all kernels", least=1)
def plot(out: Path, models: bool, source: Path | None, impact: str, **asked: Any) -> None:
    """Draw time against error of fixed steps and exact steppers; its data goes beside as JSON."""
    if out.suffix != ".svg":
        raise InputError(f"{out}: expected the name of an SVG file, as plot.svg")
    if impact != DEFAULT and not models:
        alone = f"times are drawn of {DEFAULT} alone"
        raise InputError(f"--impact {impact}: {alone}; add --models")
    require_place(out)
    if models:
        _models(out, impact)
    elif source is not None:
        write_file(out, api.plot_text(api.read_plot(source))[0])
        click.echo(f"written: {out}")
    else:
        data = out.with_suffix(".json")
        require_place(data)
        with session() as told:
            measured = api.measure_plot(**asked, session=told)
        picture, text = api.plot_text(measured)
        write_file(data, text)
        write_file(out, picture)
        rows = rows_of(measured.points)
        left_out = {"kernel", "max_slipping_error", "cases"}
        shown = [{k: v for k, v in row.items() if k not in left_out} for row in rows]
        show({"errors relative to |v1 - v2|, against the exact solution": shown}, False)
        click.echo(f"written: {out}, {data}")


def _models(out: Path, impact: str) -> None:
    with session() as told:
        drawn = api.plot_models(impact, told)
    write_file(out, drawn.svg)
    for line in drawn.lines:
        click.echo(line)
    click.echo(f"written: {out}")
