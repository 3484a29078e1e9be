"""gen emit KERNEL: the text of one kernel, byte for byte as `generated/` holds it."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("kernel", required=False)
@click.option("--header", metavar="SCENE", help="the header of a scene instead of a kernel")
@click.option("--out", type=click.Path(path_type=Path), help="file to write instead of printing")
def emit(kernel: str | None, header: str | None, out: Path | None) -> None:
    """Print the text of KERNEL, named in full, by its file or as `carom_kernel()` tells it.

    Where it was chosen these are the bytes in generated/; nothing is compiled or timed.
    """
    from ..files import require_place, write_file

    if (kernel is None) == (header is None):
        raise click.UsageError("name a kernel, or the scene of a --header")
    if out is not None:
        require_place(out)
    text = _kernel(kernel) if kernel is not None else _header(header or "")
    if out is None:
        click.echo(text, nl=False)
    else:
        write_file(out, text)


def _kernel(name: str) -> str:
    from ..choice.selection import read_selection
    from ..emission.kernel_source import emit as emitted
    from ..errors import InputError
    from ..registry.names import source_name_of, variant_named
    from .session import ROOT

    variant = variant_named(name)
    places = (ROOT / "generated" / target for target in (variant.target, "native"))
    found = [s for place in places if (s := read_selection(place / variant.scene)) is not None]
    file = f"{source_name_of(variant)}.cpp"
    chosen = [entry for s in found for entry in s.kernels if entry.file == file]
    try:
        return emitted(variant, grounds=chosen[0].grounds if chosen else "").source
    except ValueError as error:
        raise InputError(f"{name}: {error}") from None


def _header(scene: str) -> str:
    from ..emission.kernel_source import emit_header
    from ..impacts.ball_ball.scene import find_scene

    return emit_header(find_scene(scene))
