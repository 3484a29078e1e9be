"""A folder generated/IMPACT/TARGET/SCENE/: its files follow from selection.json and the sources."""

from __future__ import annotations

import difflib
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

from ..emission.kernel_source import emit
from ..errors import InputError
from ..files import write_file
from ..registry.rules import require_legal
from ..targets.target import find_target
from .selection import FILE, Selection, how_to_make, read_selection


@dataclass(frozen=True)
class Difference:
    """One file that is not as the sources give it."""

    path: Path
    what: str  # "missing", "stray" or "differs"
    diff: tuple[str, ...] = ()


def require_writable(folder: Path) -> None:
    """Make a folder and write to it, before hours are spent. Raises InputError where it cannot."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"{folder}: cannot be written: {reason}; name a folder that can with --out"
        ) from None


def checked_selection(folder: Path) -> Selection | None:
    """As read_selection, and every kernel named in it can be made. InputError names what cannot."""
    selection = read_selection(folder)
    if selection is None:
        return None
    path = folder / FILE
    cure = f"remove it, then {how_to_make(folder)} makes it anew"
    there = (selection.impact, selection.target, selection.scene)
    if there != folder.parts[-3:]:
        raise InputError(
            f"{path}: impact/target/scene: {'/'.join(there)}, but it lies elsewhere; {cure}"
        )
    for index, entry in enumerate(selection.kernels):
        asked = entry.variant.question
        try:
            require_legal(entry.variant, find_target(asked.target))
            named = (asked.impact, asked.target, asked.scene)
            if named != (selection.impact, selection.resolved, selection.scene):
                raise ValueError("the question says another impact, target or scene")
        except (ValueError, InputError) as error:
            raise InputError(f"{path}: kernels.{index}: {error}; {cure}") from None
    return selection


def files_of(selection: Selection) -> dict[str, str]:
    """Names and texts of all files of a folder, selection.json included."""
    files = {FILE: selection.text()}
    for entry in selection.kernels:
        source = emit(entry.variant, grounds=entry.grounds)
        files[entry.file] = source.source
        files["carom.h"] = source.header
    return dict(sorted(files.items()))


def write_folder(folder: Path, selection: Selection) -> list[Path]:
    """Write all files of a folder, selection.json last, and remove strays."""
    return write_files(folder, files_of(selection))


def write_files(folder: Path, files: dict[str, str]) -> list[Path]:
    """As `write_folder`, of texts that were made already."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in sorted(files, key=lambda n: n == FILE):
        write_file(folder / name, files[name])
    for stray in _strays(folder, files):
        remove(stray)
    return [folder / name for name in files]


def _strays(folder: Path, files: dict[str, str]) -> list[Path]:
    return sorted(p for p in folder.iterdir() if p.name not in files)


def strays_beside(root: Path) -> list[Path]:
    """What lies in a folder `generated` and belongs to no folder with a selection."""
    if root.resolve().name != "generated":
        return []  # a folder that a user named may hold other things of the user's
    kept = set(folders(root))
    above = {path for folder in kept for path in folder.parents[:3]} | {root}
    return sorted(p for place in above for p in place.iterdir() if p not in above | kept)


def remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink()


def _text(path: Path) -> str:
    try:
        return path.read_bytes().decode()
    except (OSError, UnicodeDecodeError) as error:
        return f"({error})"


def folders(root: Path) -> list[Path]:
    """All folders of generated/ that hold a selection, in order."""
    return sorted(path.parent for path in root.glob(f"*/*/*/{FILE}"))


def differences(folder: Path) -> list[Difference]:
    """How a folder differs from what the sources give: file set and bytes."""
    selection = checked_selection(folder)
    if selection is None:
        raise InputError(f"{folder}: no {FILE}; make it with {how_to_make(folder)}")
    return differences_from(folder, files_of(selection))


def differences_from(folder: Path, files: dict[str, str]) -> list[Difference]:
    """How a folder differs from files by name and text."""
    found = [Difference(stray, "stray") for stray in _strays(folder, files)]
    for name, text in files.items():
        path = folder / name
        if not path.exists():
            found.append(Difference(path, "missing"))
        elif (old := _text(path)) != text:
            lines = difflib.unified_diff(
                old.splitlines(), text.splitlines(), str(path), "from the sources", lineterm="", n=1
            )
            found.append(Difference(path, "differs", tuple(lines)))
    return found
