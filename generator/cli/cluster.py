"""gen worker, and the way to a Dask scheduler. Dask is an extra: nothing else needs it."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from ..errors import InputError

if TYPE_CHECKING:
    from distributed import Client

_CONNECT = 15.0  # seconds
_MISSING = "Dask is not installed: .venv/bin/python -m pip install -r requirements-cluster.lock"


@contextmanager
def connected(address: str) -> Iterator[Client]:
    """A client of a scheduler. Raises InputError where there is none, or no Dask."""
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise InputError(f"--scheduler {address}: {_MISSING}") from None
    try:
        client = Client(address, timeout=_CONNECT)
    except (OSError, ValueError) as error:
        raise InputError(
            f"--scheduler {address}: no Dask scheduler answers there: {error}; start one with "
            ".venv/bin/dask scheduler"
        ) from None
    with client:
        yield client


@click.command()
@click.argument("address")
@click.option("--threads", type=click.IntRange(1, 64), help="builds at once; default: all CPUs")
def worker(address: str, threads: int | None) -> None:
    """Do the jobs of sweeps that go to the scheduler at ADDRESS; announces this machine's CPU."""
    from ..targets.host import read_host

    host = read_host()
    if not host.exact:
        raise InputError(f"worker: {host.cpu} is none of the targets; see ./gen list targets")
    try:
        from distributed import Nanny

        from ..sweep.worker import resource_of
    except ModuleNotFoundError:
        raise InputError(f"worker: {_MISSING}") from None

    async def work() -> None:
        count = threads or os.cpu_count() or 1
        resources = {resource_of(host.target.name): 1.0}
        async with Nanny(address, nthreads=count, resources=resources) as nanny:
            click.echo(f"carom: worker for {host.target.name}, {count} threads; Ctrl-C ends it")
            await nanny.finished()

    try:
        asyncio.run(work())
    except (OSError, TimeoutError) as error:
        raise InputError(f"worker {address}: no Dask scheduler answers there: {error}") from None
