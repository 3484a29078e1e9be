"""gen emit QUESTION RECIPE: the text of one kernel, byte for byte as `generated/` holds it."""

from __future__ import annotations

from pathlib import Path

import click

from .. import api
from ..files import require_place, write_file
from . import options
from .show import session


@click.command()
@click.argument("kernel", nargs=-1, metavar="[QUESTION [RECIPE]]")
@click.option("--header", metavar="[IMPACT/]SCENE", help="the header of a scene instead")
@click.option("--out", type=options.PLACE, help="file to write instead of printing")
def emit(kernel: tuple[str, ...], header: str | None, out: Path | None) -> None:
    """Print the text of the kernel that answers QUESTION by RECIPE; without one, of the chosen one.

    QUESTION: impact/target/scene/model-goal-width, or a file of generated/. Where the kernel was
    chosen these are the bytes in generated/; nothing is compiled or timed.
    """
    if bool(kernel) == (header is not None):
        raise click.UsageError("name a question, or the scene of a --header")
    if out is not None:
        require_place(out)
    with session() as told:
        text = api.header(header) if header is not None else api.emit(" ".join(kernel), told)
    if out is None:
        click.echo(text, nl=False)
    else:
        write_file(out, text)
