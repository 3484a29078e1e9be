"""The one writer of files: whole or not at all, and to wherever a path leads.

Links are followed. A regular file is replaced in one step and keeps its mode and, where that is
allowed, its owner; a new one gets what the umask leaves. Devices, fifos and open files (as
/dev/stdout) are written through. A read-only file is refused, to root too.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import re
import secrets
import stat
import sys
from dataclasses import dataclass
from pathlib import Path

from .errors import InputError
from .places import CACHE_CURE

_MOST_LINKS = 40  # as Linux follows
_SOME = 2**20  # bytes; a disk that has no room for them is full


@dataclass(frozen=True)
class _Destination:
    """Where a path leads: every link followed but those to an open file of a process."""

    place: Path
    old: os.stat_result | None  # of what is there; None: a new file
    descriptor: int | None  # where it is an open file of this process

    @property
    def regular(self) -> bool:
        return self.old is None or (
            stat.S_ISREG(self.old.st_mode) and not _is_open_file(self.place)
        )


def _is_open_file(place: Path) -> re.Match[str] | None:
    return re.fullmatch(r"/proc/(\d+)/(?:task/\d+/)?fd/(\d+)", str(place))


def _followed(path: Path) -> Path:
    for _ in range(_MOST_LINKS):
        place = Path(os.path.realpath(path.parent), path.name)
        if _is_open_file(place) or not place.is_symlink():
            return place
        path = place.parent / os.readlink(place)
    raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))


def _found(path: Path) -> _Destination:
    place = _followed(path)
    opened = _is_open_file(place)
    if opened and int(opened[1]) == os.getpid():
        number = int(opened[2])
        if fcntl.fcntl(number, fcntl.F_GETFL) & os.O_ACCMODE == os.O_RDONLY:
            raise OSError(errno.EBADF, "open for reading alone")
        return _Destination(place, os.fstat(number), number)
    try:
        return _Destination(place, place.stat(), None)
    except FileNotFoundError:
        return _Destination(place, None, None)


def _obstacle(found: _Destination) -> str:
    """Why nothing can be written there, and what would help; empty where it can."""
    old, folder = found.old, found.place.parent
    if old is not None and stat.S_ISDIR(old.st_mode):
        return "is a folder; expected the name of a file"
    if old is not None and found.descriptor is None:
        mode = stat.S_IMODE(old.st_mode)
        if not mode & 0o222:
            return f"is read-only (mode {mode:04o}); make it writable, or name another file"
        if not os.access(found.place, os.W_OK):
            return f"{_denied(found.place)}; name another file"
    if not found.regular:
        return ""
    if not folder.is_dir():
        return f"there is no folder {folder}; make it first"
    return "" if os.access(folder, os.W_OK) else _denied(folder)


def _denied(place: Path) -> str:
    if os.statvfs(place).f_flag & os.ST_RDONLY:
        return f"{place} is on a disk that is mounted read-only"
    return f"no permission to write {'in' if place.is_dir() else 'to'} {place}"


def _destination(path: Path) -> _Destination:
    try:
        found = _found(path)
        obstacle = _obstacle(found)
    except OSError as error:
        raise _unwritable(path, error) from None
    if obstacle:
        raise InputError(f"{path}: {obstacle}")
    return found


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError(f"{path}: cannot be written: {error.strerror or error}")


def require_place(path: Path) -> None:
    """Raise InputError where a file cannot be written, before any work is done for it."""
    _destination(path)


def require_regular(path: Path) -> None:
    """As `require_place`, for what must be a regular file, new or there already."""
    if not _destination(path).regular:
        raise InputError(f"{path}: is a device, fifo or open file; expected a regular file")


def is_stdout(path: Path) -> bool:
    """Is what is written there this process's standard output? Messages then go elsewhere."""
    return _destination(path).descriptor == 1


def write_file(path: Path, data: str | bytes, parents: bool = False) -> None:
    """Write a file. Raises InputError where that cannot be done; what was there is then kept.

    `parents`: its folder is made where there is none.
    """
    raw = data.encode() if isinstance(data, str) else data
    try:
        if parents:
            path.parent.mkdir(parents=True, exist_ok=True)
        found = _destination(path)
        if found.regular:
            _replace(found, raw)
        else:
            _write_through(found, raw)
    except OSError as error:
        raise _unwritable(path, error) from None


def require_cache(folder: Path) -> None:
    """Raise InputError where programs cannot be kept in the cache and run from it."""
    probe = folder / f".carom-{secrets.token_hex(8)}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        try:
            probe.write_bytes(bytes(_SOME))
            probe.chmod(0o700)
            runs = os.access(probe, os.X_OK)
        finally:
            probe.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"cache {folder}: {error.strerror or error}; {CACHE_CURE}") from None
    if not runs:
        raise InputError(
            f"cache {folder}: no program can be run there (mounted noexec?); {CACHE_CURE}"
        )


def require_temporary() -> None:
    """Raise InputError where TMPDIR names no place for the files that compilers leave between."""
    named = os.environ.get("TMPDIR")
    if named and not os.access(named, os.W_OK | os.X_OK):
        reason = "cannot be written" if os.path.exists(named) else "there is no such folder"
        raise InputError(f"TMPDIR={named}: {reason}; name one that can be written, or unset it")


def line_of(error: OSError) -> str:
    """An error of the system that nobody expected, as one line with its place and a cure."""
    name = f"{os.fsdecode(error.filename)}: " if isinstance(error.filename, str | bytes) else ""
    cure = ""
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        cure = "; free some space, or name other folders with CAROM_CACHE and TMPDIR"
    if error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
        cure = f"; where that is a cache, {CACHE_CURE}"
    return f"{name}{error.strerror or error}{cure}"


def _write_through(found: _Destination, raw: bytes) -> None:
    sys.stdout.flush()  # what was said before comes first
    number = found.descriptor
    handle = os.open(found.place, os.O_WRONLY) if number is None else os.dup(number)
    with os.fdopen(handle, "wb") as stream:
        stream.write(raw)


def _replace(found: _Destination, raw: bytes) -> None:
    fresh = found.place.with_name(f".carom-{secrets.token_hex(8)}")  # no longer than a name may be
    options = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
    handle = os.open(fresh, options, 0o666 if found.old is None else 0o600)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(raw)
            stream.flush()
            if found.old is not None:
                keep_rights(handle, found.old)
            os.fsync(handle)
        os.replace(fresh, found.place)
    except BaseException:
        os.unlink(fresh)
        raise


def keep_rights(fresh: int | Path, old: os.stat_result) -> None:
    """Give a file or folder the owner, where that is allowed, and the mode of the one before."""
    for owner in (-1, old.st_uid):
        with contextlib.suppress(PermissionError):
            os.chown(fresh, owner, old.st_gid)
    with contextlib.suppress(PermissionError):  # a file system may have no modes
        os.chmod(fresh, stat.S_IMODE(old.st_mode))
