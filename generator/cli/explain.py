"""gen explain QUESTION RECIPE: the derivation, the options and the operation counts of a kernel."""

from __future__ import annotations

from collections.abc import Sequence

import click

from .. import api
from .show import session


@click.command()
@click.argument("kernel", nargs=-1, required=True, metavar="QUESTION [RECIPE] | PRESET")
@click.option("--target", default="x86-64-v3", show_default=True, help="for a preset")
@click.option("--model", help="for a preset; default: the first of list models")
def explain(kernel: tuple[str, ...], target: str, model: str | None) -> None:
    """Explain a kernel: by question and recipe, by its file, or a preset (see list variants)."""
    with session() as told:
        found = api.explain(" ".join(kernel), target, model, told)
    click.echo(f"{found.kernel}\n\nSymbols:")
    _columns(found.legend, 2)
    click.echo("\nOptions:")
    _columns(found.options, 2)
    click.echo("\nDerivation:")
    for chapter in found.derivation:
        click.echo(f"  {chapter.title}:")
        for symbol, form in chapter.formulas:
            click.echo(f"    {symbol} = {form}")
    click.echo(f"\nOperations of one step{'' if found.exact else ' (one iteration of the loop)'}:")
    click.echo(f"  {found.counts}; {found.flops} flops, an FMA being two")


def _columns(rows: Sequence[tuple[str, ...]], indent: int) -> None:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        click.echo(" " * indent + "  ".join(cells).rstrip())
