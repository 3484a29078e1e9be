"""The way to a Dask scheduler, and a worker's life. Dask is an extra: nothing else needs it."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ..errors import InputError
from ..targets.host import read_host

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


def work(
    address: str, threads: int | None = None, ready: Callable[[str, int], None] | None = None
) -> None:
    """Do the jobs of sweeps that go to the scheduler at an address, until it ends.

    `threads`: builds at once; None: all CPUs. `ready` is told the target and the threads when the
    worker has announced itself. Raises InputError where this CPU is no target, where no scheduler
    answers, and where there is no Dask.
    """
    host = read_host()
    if not host.exact:
        raise InputError(f"worker: {host.cpu} is none of the targets; see ./gen list targets")
    try:
        from distributed import Nanny

        from ..sweep.worker import resource_of
    except ModuleNotFoundError:
        raise InputError(f"worker: {_MISSING}") from None
    count = threads or os.cpu_count() or 1

    async def live() -> None:
        resources = {resource_of(host.target.name): 1.0}
        async with Nanny(address, nthreads=count, resources=resources) as nanny:
            if ready is not None:
                ready(host.target.name, count)
            await nanny.finished()

    try:
        asyncio.run(live())
    except (OSError, TimeoutError) as error:
        raise InputError(f"worker {address}: no Dask scheduler answers there: {error}") from None
