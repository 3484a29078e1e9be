"""Ctrl-C that cannot be lost."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType
from typing import TypeVar

Told = TypeVar("Told")


@contextmanager
def kept(observe: Callable[[Told], None]) -> Iterator[Callable[[Told], None]]:
    """`observe`, which first raises KeyboardInterrupt again where one came before and was lost.

    Python drops an exception that a signal raises in a finaliser or in a callback of a library: a
    sweep would then go on to its end. There is no Ctrl-C in another thread than the main one, nor
    where it is ignored, as for a job in the background.
    """
    came = False

    def note(_number: int, _frame: FrameType | None) -> None:
        nonlocal came
        came = True
        raise KeyboardInterrupt

    def watched(told: Told) -> None:
        if came:
            raise KeyboardInterrupt
        observe(told)

    ignored = signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    if ignored or current_thread() is not main_thread():
        yield observe
        return
    before = signal.signal(signal.SIGINT, note)
    try:
        yield watched
    finally:
        signal.signal(signal.SIGINT, before)
