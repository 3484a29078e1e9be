"""gen results: records of timings, in the stores of sweeps and as text by CPU."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .. import api
from . import options
from .show import command_line, session, show
from .watch import say_best, watched


@click.group()
def results() -> None:
    """Work with the records of timings: stores of sweeps, and `timings/CPU.jsonl`."""


@results.command()
@click.argument("stores", nargs=-1, required=True, type=options.PLACE)
@click.option("--out", required=True, type=options.PLACE, help="store or file to add to")
@options.JSON
def merge(stores: tuple[Path, ...], out: Path, as_json: bool) -> None:
    """Put the records of STORES, each once, into one, new or there already.

    STORES: all of sweeps (SQLite), or all files of timings (.jsonl). A file is the same whatever
    the order; a damaged line is named and left out.
    """
    with session() as told:
        added = api.merge(stores, out, told)
    if as_json:
        show({"": [{"file": path, "added": count} for path, count in added.items()]}, True)
        return
    for path, count in added.items():
        click.echo(f"{path}: {count} records added")
    click.echo(f"written: {out}")


@results.command()
@click.option("--cpu", default="native", show_default=True, help="target whose records to take")
@options.STORE
@click.option("--out", type=options.PLACE, help="file to add to; default: timings/CPU.jsonl")
def export(cpu: str, store: Path | None, out: Path | None) -> None:
    """Add what a sweep's store has timed on a CPU to its file of records."""
    with session() as told:
        text = api.export(cpu, store, out, told)
    click.echo(text)


@results.command(name="import")
@click.argument("file", type=options.PLACE)
@options.JSON
def import_file(file: Path, as_json: bool) -> None:
    """Add the records of FILE to timings/, each to the file of its CPU; damaged lines are named."""
    with session() as told:
        added = api.import_records(file, told)
    if as_json:
        rows = [{"file": path, "new": new, "of": of} for path, (new, of) in added.items()]
        show({"": rows}, True)
        return
    for path, (new, of) in added.items():
        click.echo(f"{path}: {new} of {of} records were new")


@results.command()
@click.option("--cpu", default="native", show_default=True, help="must be this machine's")
@click.option("--minutes", default=30.0, show_default=True, type=click.FloatRange(min=0.1))
@click.option(
    "--max-error", "budgets", multiple=True, type=float, default=[1e-6], help="default: 1e-6"
)
@click.option("--model", "models", multiple=True, help="contact models; default: all")
@click.option(
    "--store", type=options.PLACE, help="keeps each timing at once; default: in the cache"
)
@click.option("--out", type=options.PLACE, help="file to add to; default: timings/CPU.jsonl")
def refresh(**asked: Any) -> int:
    """Time the contests of this machine's CPU and add the records to its file.

    Fixed steps and exact kernels, single calls and batches. Stopped at any moment, nothing that was
    timed is lost, and the same command goes on from there.
    """
    request = api.RefreshRequest(**asked, command=command_line())
    with session() as told, watched(told, request.minutes) as observe:
        outcomes = api.refresh(request, observe, click.echo, told)
    say_best(outcomes)
    return 1 if any(outcome.failed for outcome in outcomes) else 0
