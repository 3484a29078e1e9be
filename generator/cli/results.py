"""gen results: records of timings, in the stores of sweeps and as text by CPU."""

from __future__ import annotations

from pathlib import Path

import click

MINUTES = 30.0
_PLACE = click.Path(path_type=Path)


@click.group()
def results() -> None:
    """Work with the records of timings: stores of sweeps, and `timings/CPU.jsonl`."""


def _note(line: str) -> None:
    click.echo(f"carom: {line}", err=True)


@results.command()
@click.argument("stores", nargs=-1, required=True, type=_PLACE)
@click.option("--out", required=True, type=_PLACE, help="store or file to add to")
def merge(stores: tuple[Path, ...], out: Path) -> None:
    """Put the records of STORES, each once, into one, new or there already.

    STORES: all of sweeps (SQLite), or all files of timings (.jsonl). A file is the same whatever
    the order; a damaged line is named and left out.
    """
    from ..errors import InputError
    from ..sweep.store import merge as merged

    if out.resolve() in [path.resolve() for path in stores]:
        raise InputError(f"--out {out}: is one of the stores that are read; name another")
    if not out.parent.is_dir():
        raise InputError(f"--out {out}: there is no folder {out.parent}; make it first")
    texts = {path.suffix == ".jsonl" for path in (*stores, out)}
    if len(texts) > 1:
        raise InputError(f"--out {out}: stores and files of timings (.jsonl) do not mix")
    added = _merged_files(stores, out) if texts == {True} else merged(stores, out)
    for path, count in added.items():
        click.echo(f"{path}: {count} records added")
    click.echo(f"written: {out}")


def _merged_files(files: tuple[Path, ...], out: Path) -> dict[Path, int]:
    from ..evidence.records.files import read_records, union, write_records

    found = {path: read_records(path) for path in files}
    known = read_records(out).records if out.exists() else ()
    for file in found.values():
        for line in file.damaged:
            _note(line)
    added = {}
    for path, file in found.items():
        after = union(known, file.records)
        added[path], known = len(after) - len(union(known)), after
    write_records(out, known)
    return added


@results.command()
@click.option("--cpu", default="native", show_default=True, help="target whose records to take")
@click.option("--store", type=_PLACE, help="store of a sweep; default: that in the cache")
@click.option("--out", type=_PLACE, help="file to add to; default: timings/CPU.jsonl")
def export(cpu: str, store: Path | None, out: Path | None) -> None:
    """Add what a sweep's store has timed on a CPU to its file of records."""
    from ..evidence.records.files import timings_path
    from ..files import require_place
    from ..places import cache_folder
    from ..sweep.refresh import add_exported
    from ..sweep.store import default_store, read_only
    from .session import ROOT, resolve_target

    target = resolve_target(cpu)[0].name
    place = out or timings_path(ROOT, target)
    if out is not None:
        require_place(out)
    with read_only(store or default_store(cache_folder())) as opened:
        click.echo(add_exported(opened, target, place, _note))


@results.command(name="import")
@click.argument("file", type=_PLACE)
def import_file(file: Path) -> None:
    """Add the records of FILE to timings/, each to the file of its CPU; damaged lines are named."""
    from ..evidence.records.files import read_records, timings_path, write_records
    from ..targets.target import find_target
    from .session import ROOT

    found = read_records(file)
    for line in found.damaged:
        _note(line)
    cpus = sorted({record.cpu.target for record in found.records})
    for cpu in cpus:
        find_target(cpu)
    for cpu in cpus:
        path = timings_path(ROOT, cpu)
        there = read_records(path).records if path.exists() else ()
        own = [record for record in found.records if record.cpu.target == cpu]
        after = write_records(path, (*there, *own))
        click.echo(f"{path}: {after - len(there)} of {len(own)} records were new")


@results.command()
@click.option("--cpu", default="native", show_default=True, help="must be this machine's")
@click.option("--minutes", default=MINUTES, show_default=True, type=click.FloatRange(min=0.1))
@click.option("--max-error", multiple=True, type=float, default=[1e-6], help="default: 1e-6")
@click.option("--model", "models", multiple=True, help="contact models; default: all")
@click.option("--store", type=_PLACE, help="keeps each timing at once; default: in the cache")
@click.option("--out", type=_PLACE, help="file to add to; default: timings/CPU.jsonl")
def refresh(
    cpu: str,
    minutes: float,
    max_error: tuple[float, ...],
    models: tuple[str, ...],
    store: Path | None,
    out: Path | None,
) -> int:
    """Time the contests of this machine's CPU and add the records to its file.

    Fixed steps and exact kernels, single calls and batches. Stopped at any moment, nothing that was
    timed is lost, and the same command goes on from there.
    """
    from .refresh import run

    return run(cpu, minutes, max_error, models, store, out)
