"""Run a program without a shell and never wait for it without end."""

from __future__ import annotations

import contextlib
import math
import os
import resource
import signal
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..errors import InputError, KernelError, KernelTimeout
from ..files import write_file
from .reasons import reason_in

_FULL = "No space left on device"


_PATIENCE = 10


@dataclass(frozen=True)
class Finished:
    """What a program left behind."""

    code: int
    output: str
    errors: str

    @property
    def first_error(self) -> str:
        """The first reason that is given, as one line."""
        return reason_in(self.errors) or reason_in(self.output) or f"exit status {self.code}"

    @property
    def log(self) -> str:
        return "\n".join(text for text in (self.output.strip(), self.errors.strip()) if text)


def run(
    command: Sequence[str],
    timeout: float,
    cwd: Path | None = None,
    text: str = "",
    environment: Mapping[str, str] | None = None,
) -> Finished:
    """Run a command with messages in English; at the time-out its whole process group is killed.

    `environment`: variables beside those of this process.

    Raises KernelError where the program cannot be started, KernelTimeout where it takes longer than
    `timeout` seconds, on a busy machine up to _PATIENCE times as long.
    """
    try:
        process = subprocess.Popen(
            list(command),
            cwd=cwd,
            env={**os.environ, **(environment or {}), "LC_ALL": "C"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            start_new_session=True,  # a compiler driver's children are killed with it
        )
    except OSError as error:
        raise KernelError(f"cannot run {command[0]}: {error.strerror or error}") from None
    _limit_cpu_time(process.pid, timeout)
    try:
        output, errors = _communicated(process, text, timeout)
    except subprocess.TimeoutExpired:
        raise KernelTimeout(f"{Path(command[0]).name} took longer than {timeout:g} s") from None
    finally:
        if process.returncode is None:  # timed out or interrupted
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
    return Finished(process.returncode, output, errors)


def require_space(done: Finished, where: Path) -> None:
    """Raise InputError where a program failed because a disk is full."""
    if done.code != 0 and _FULL in done.errors + done.output:
        raise InputError(
            f"{where}: {done.first_error}; free some space, or name other folders with CAROM_CACHE "
            "and TMPDIR"
        )


def run_checked(command: Sequence[str], timeout: float, what: str, log: Path) -> None:
    """As `run`; where it fails, KernelError gives the first reason and the log that has all."""
    done = run(command, timeout)
    if done.code == 0:
        return
    require_space(done, log.parent)
    write_file(log, f"$ {' '.join(command)}\n{done.log}\n", parents=True)
    raise KernelError(f"{what}: {done.first_error} (log: {log})")


def _communicated(process: subprocess.Popen[str], text: str, timeout: float) -> tuple[str, str]:
    """What it prints. One that had less than half of the time for itself is waited for again."""
    given: str | None = text
    for _ in range(_PATIENCE):
        try:
            return process.communicate(given, timeout=timeout)
        except subprocess.TimeoutExpired:
            if _own_time(process.pid) > 0.5 * timeout:
                raise
            given = None  # it was sent
    raise subprocess.TimeoutExpired(process.args, _PATIENCE * timeout)


def _own_time(session: int) -> float:
    """CPU seconds of the processes of a session so far; endless where the system tells none."""
    used, known = 0, False
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):  # it has ended
            fields = stat.read_text(errors="replace").rsplit(")", 1)[1].split()
            known = True
            if int(fields[3]) == session:
                used += sum(map(int, fields[11:15]))  # its own, and of children that have ended
    return used / os.sysconf("SC_CLK_TCK") if known else math.inf


def _limit_cpu_time(pid: int, timeout: float) -> None:
    """So that a program that never ends does not outlive us when we are killed."""
    seconds = int(timeout) + 10
    # There may be no such call here, a lower limit already, or no such process any more.
    with contextlib.suppress(AttributeError, OSError, ValueError):
        resource.prlimit(pid, resource.RLIMIT_CPU, (seconds, seconds))
