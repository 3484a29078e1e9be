"""gen sweep: the whole registry for one CPU, every trial kept."""

from __future__ import annotations

from pathlib import Path

import click

DEFAULT_MINUTES = 19.0


@click.command()
@click.option("--target", default="native", show_default=True, help="CPU to sweep for")
@click.option("--scene", default="any", show_default=True)
@click.option("--model", help="contact model; default: the scene's")
@click.option("--steps", type=click.IntRange(1, 10**8), help="fixed steps only, so many")
@click.option("--max-error", type=float, help="exact kernels only, within this error budget")
@click.option("--call", type=click.Choice(["scalar", "batch"]), help="one kind of kernels only")
@click.option("--only", multiple=True, metavar="AXIS=CODE,...", help="codes an option may have")
@click.option(
    "--minutes",
    type=click.FloatRange(min=0.1),
    help=f"default: {DEFAULT_MINUTES:g}, none with --trials or --exhaustive",
)
@click.option("--trials", type=click.IntRange(1), help="at most so many new ones")
@click.option("--exhaustive", is_flag=True, help="every legal variant instead of a search")
@click.option("--seed", default=1, show_default=True, help="of what is drawn at random")
@click.option("--store", type=click.Path(path_type=Path), help="file that keeps the records")
@click.option("--fresh", is_flag=True, help="make every trial anew; what is stored stays")
@click.option("--write", is_flag=True, help="make generated/TARGET/SCENE/ of what was chosen")
@click.option("--out", type=click.Path(path_type=Path), help="with --write: not generated/")
@click.option("--verify-choice", is_flag=True, help="only time the choice against the next best")
@click.option(
    "--rivals",
    type=click.Path(path_type=Path),
    help="with --verify-choice: a store with more kernels to time it against",
)
@click.option("--best", default=5, show_default=True, type=click.IntRange(2, 64), help="so many")
@click.option("--scheduler", metavar="ADDRESS", help="of a Dask cluster that does the jobs")
@click.option("--wait", default=60.0, show_default=True, help="seconds for a worker to appear")
def sweep(minutes: float | None, **asked: object) -> int:
    """Explore the registry for a CPU, keep every trial, choose the fastest kernels."""
    from .sweep_run import Asked, run

    if minutes is None and asked["trials"] is None and not asked["exhaustive"]:
        minutes = DEFAULT_MINUTES
    return run(Asked(minutes=minutes, **asked))  # type: ignore[arg-type]
