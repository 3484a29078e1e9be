"""The errors that reach a user, by exit status."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

T = TypeVar("T")


class InputError(Exception):
    """Wrong usage or input: one line that names the place, what is wrong and what would be right.

    The command line prints the line and exits with 2; nothing has been written.
    """


class KernelError(Exception):
    """A check or a kernel failed: the command line prints the line and exits with 1."""


class EmissionError(KernelError):
    """A variant that is legal, and yet no text could be made of it."""


class KernelTimeout(KernelError):  # noqa: N818
    """A program took longer than it may."""


class KernelCrash(KernelError):  # noqa: N818
    """A program was ended by a signal."""


def named(what: str, name: str, known: Mapping[str, T]) -> T:
    """What is known by a name. Raises InputError that names the option and what there is."""
    if name not in known:
        raise InputError(f"--{what} {name}: no such {what}; there are {', '.join(known)}")
    return known[name]
