"""The errors that reach a user, by exit status."""

from __future__ import annotations


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
