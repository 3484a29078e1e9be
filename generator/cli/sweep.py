"""gen sweep: the whole registry for one CPU, every trial kept; gen worker does its jobs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .. import api
from ..errors import InputError
from . import options
from .show import command_line, session
from .watch import say_outcomes, say_stopped, say_verified, watched


@click.command()
@options.IMPACT
@options.TARGET
@options.SCENE
@options.MODEL
@click.option("--steps", type=click.IntRange(1, 10**8), help="fixed steps only, so many")
@click.option("--max-error", type=float, help="exact kernels only, within this error budget")
@click.option("--call", type=click.Choice(["scalar", "batch"]), help="one kind of kernels only")
@click.option("--only", multiple=True, metavar="AXIS=CODE,...", help="codes an option may have")
@click.option(
    "--minutes",
    type=click.FloatRange(min=0.1),
    help="default: 19, none with --trials or --exhaustive",
)
@click.option("--trials", type=click.IntRange(1), help="at most so many new ones")
@click.option("--exhaustive", is_flag=True, help="every legal variant instead of a search")
@click.option("--seed", default=1, show_default=True, help="of what is drawn at random")
@click.option("--store", type=options.PLACE, help="file that keeps the records")
@click.option("--fresh", is_flag=True, help="make every trial anew; what is stored stays")
@click.option("--write", is_flag=True, help="make a folder of generated/ of what was chosen")
@click.option("--out", type=options.PLACE, help="with --write: not generated/")
@click.option("--verify-choice", is_flag=True, help="only time the choice against the next best")
@click.option(
    "--rivals",
    type=options.PLACE,
    help="with --verify-choice: a store with more kernels to time it against",
)
@click.option("--best", default=5, show_default=True, type=click.IntRange(2, 64), help="so many")
@click.option("--scheduler", metavar="ADDRESS", help="of a Dask cluster that does the jobs")
@click.option("--wait", default=60.0, show_default=True, help="seconds for a worker to appear")
def sweep(verify_choice: bool, rivals: Path | None, best: int, **asked: Any) -> int:
    """Explore the registry for a CPU, keep every trial, choose the fastest kernels."""
    if rivals is not None and not verify_choice:
        raise InputError(f"--rivals {rivals}: is for --verify-choice, which was not given")
    request = api.SweepRequest(**asked, command=command_line())
    with session() as told:
        try:
            with watched(told, request.limit, request.trials) as observe:
                if verify_choice:
                    finals = api.verify_choices(request, best, rivals, observe, told)
                else:
                    swept = api.sweep(request, observe, told)
        except KeyboardInterrupt:
            say_stopped(request.place(told))
            raise
    if verify_choice:
        held = [say_verified(final) for final in finals]
        return 0 if all(held) else 1
    say_outcomes(swept)
    return 1 if swept.failed else 0


@click.command()
@click.argument("address")
@click.option("--threads", type=click.IntRange(1, 64), help="builds at once; default: all CPUs")
def worker(address: str, threads: int | None) -> None:
    """Do the jobs of sweeps that go to the scheduler at ADDRESS; announces this machine's CPU."""
    api.work(
        address,
        threads,
        lambda name, count: click.echo(
            f"carom: worker for {name}, {count} threads; Ctrl-C ends it"
        ),
    )
