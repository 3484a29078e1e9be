"""A vendored folder: written whole or not at all, and compared with what it should be."""

from __future__ import annotations

import ctypes
import os
import secrets
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from ..errors import InputError
from ..files import keep_rights
from .manifest import FILE, Manifest, read_manifest, sha256_of

_AT_FDCWD, _EXCHANGE = -100, 2  # of Linux's renameat2


@dataclass(frozen=True)
class HandChange:
    """A file that is not what the manifest says it was."""

    name: str
    what: str  # "edited", "missing" or "added"


def hand_changes(folder: Path, manifest: Manifest) -> tuple[HandChange, ...]:
    """What somebody changed since the folder was made, the manifest itself included."""
    changes = []
    wanted = {**manifest.files, FILE: sha256_of(manifest.hashed().text())}
    for name, sha256 in wanted.items():
        try:
            found = sha256_of((folder / name).read_bytes())
        except OSError:
            changes.append(HandChange(name, "missing"))
            continue
        if found != sha256:
            changes.append(HandChange(name, "edited"))
    here = sorted(p.relative_to(folder).as_posix() for p in folder.rglob("*") if not p.is_dir())
    changes += [HandChange(name, "added") for name in here if name not in wanted]
    return tuple(changes)


def require_replaceable(folder: Path, edited_too: bool = False) -> None:
    """Raise InputError where writing would destroy what somebody else has put there.

    `edited_too`: changes by hand in a vendored folder may go.
    """
    if not folder.exists():
        _require_maker(folder)
        return
    if not folder.is_dir():
        raise InputError(f"--out {folder}: is no folder; name one that is empty or not there yet")
    if not any(folder.iterdir()):
        return
    if not (folder / FILE).exists():
        raise InputError(
            f"--out {folder}: holds other files and no {FILE}; name an empty folder or a new one"
        )
    changes = hand_changes(folder, read_manifest(folder))
    if changes and not edited_too:
        first = changes[0]
        raise InputError(
            f"--out {folder}: {first.name} was {first.what} by hand ({len(changes)} such in all); "
            "keep your changes elsewhere, then remove the folder or use --force"
        )


def _require_maker(folder: Path) -> None:
    """Raise InputError where the folder cannot be made, before hours are spent."""
    above = next(place for place in folder.resolve().parents if place.exists())
    if not above.is_dir():
        raise InputError(f"--out {folder}: {above} is no folder")
    if not os.access(above, os.W_OK | os.X_OK):
        raise InputError(f"--out {folder}: no permission to write in {above}")


@contextmanager
def staged(folder: Path) -> Iterator[Path]:
    """A new folder beside `folder` that takes its place when all went well.

    Whatever fails or is killed before leaves `folder` as it was. InputError where there is no
    place or no permission.
    """
    final = folder.resolve()
    scratch = final.with_name(f".carom-{secrets.token_hex(8)}")
    try:
        scratch.mkdir(parents=True)
        yield scratch
        if final.exists():
            keep_rights(scratch, final.stat())
        _swap(scratch, final)
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written: {error.strerror or error}") from None
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def write_files(folder: Path, files: Mapping[str, str]) -> None:
    """Plain files in an empty folder, on the disk when it returns."""
    for name, text in files.items():
        with (folder / name).open("wb") as stream:
            stream.write(text.encode())
            stream.flush()
            os.fsync(stream.fileno())


def _swap(fresh: Path, final: Path) -> None:
    """Put `fresh` in the place of `final`; what was there is then at `fresh`, if anywhere."""
    if not final.exists():
        fresh.rename(final)
        return
    if _exchange(fresh, final):
        return
    old = Path(tempfile.mkdtemp(prefix=f".{final.name}.old.", dir=final.parent))
    final.rename(old)
    try:
        fresh.rename(final)
    except OSError:
        old.rename(final)
        raise
    shutil.rmtree(old, ignore_errors=True)


def _exchange(one: Path, other: Path) -> bool:
    """Exchange two folders in one step, where the system can."""
    renameat2 = getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None)
    if renameat2 is None:
        return False
    done = renameat2(_AT_FDCWD, os.fsencode(one), _AT_FDCWD, os.fsencode(other), _EXCHANGE)
    return int(done) == 0
