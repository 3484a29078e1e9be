"""gen results: stores of sweeps."""

from __future__ import annotations

from pathlib import Path

import click


@click.group()
def results() -> None:
    """Work with the stores that sweeps keep their records in."""


@results.command()
@click.argument("stores", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--out", required=True, type=click.Path(path_type=Path), help="store to add to")
def merge(stores: tuple[Path, ...], out: Path) -> None:
    """Put the records of STORES, each once, into one store, new or there already."""
    from generator.errors import InputError
    from generator.sweep.store import merge as merged

    if out.resolve() in [path.resolve() for path in stores]:
        raise InputError(f"--out {out}: is one of the stores that are read; name another")
    if not out.parent.is_dir():
        raise InputError(f"--out {out}: there is no folder {out.parent}; make it first")
    for path, count in merged(stores, out).items():
        click.echo(f"{path}: {count} records added")
    click.echo(f"written: {out}")
