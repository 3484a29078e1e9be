"""gen emit KERNEL: the text of one kernel, byte for byte as `generated/` holds it."""

from __future__ import annotations

from pathlib import Path

import click

from .. import api
from ..files import require_place, write_file
from . import options
from .show import session


@click.command()
@click.argument("kernel", required=False)
@click.option("--header", metavar="SCENE", help="the header of a scene instead of a kernel")
@click.option("--out", type=options.PLACE, help="file to write instead of printing")
def emit(kernel: str | None, header: str | None, out: Path | None) -> None:
    """Print the text of KERNEL, named in full, by its file or as `carom_kernel()` tells it.

    Where it was chosen these are the bytes in generated/; nothing is compiled or timed.
    """
    if (kernel is None) == (header is None):
        raise click.UsageError("name a kernel, or the scene of a --header")
    if out is not None:
        require_place(out)
    with session() as told:
        text = api.header(header) if header is not None else api.emit(kernel or "", told)
    if out is None:
        click.echo(text, nl=False)
    else:
        write_file(out, text)
