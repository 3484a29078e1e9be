"""A folder generated/<target>/<scene>/: its files follow from selection.json and the sources."""

from __future__ import annotations

import difflib
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

from ..emission.kernel_source import emit
from ..errors import InputError
from ..files import write_file
from ..impacts.ball_ball.models import find_model
from ..impacts.ball_ball.scene import find_scene
from ..registry.names import source_name_of, variant_of
from ..registry.rules import require_legal
from ..targets.target import find_target
from .selection import FILE, Selection, read_selection


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


def file_of(kernel: str) -> str:
    """The file of a kernel: its name without what only the compiler sees."""
    return f"{source_name_of(variant_of(kernel))}.cpp"


def checked_selection(folder: Path) -> Selection | None:
    """As read_selection, and every kernel named in it can be made. InputError names what cannot."""
    selection = read_selection(folder)
    if selection is None:
        return None
    path = folder / FILE
    cure = (
        f"remove it, then ./gen --target {folder.parent.name} --scene {folder.name} makes it anew"
    )
    if (selection.target, selection.scene) != (folder.parent.name, folder.name):
        there = f"{selection.target}/{selection.scene}"
        raise InputError(f"{path}: target/scene: {there}, but it lies elsewhere; {cure}")
    for index, entry in enumerate(selection.kernels):
        try:
            variant = variant_of(entry.kernel)
            require_legal(variant, find_target(variant.target))
            find_scene(variant.scene)
            find_model(variant.model)
            named = (variant.target, variant.scene, variant.model, file_of(entry.kernel))
            if named != (selection.resolved, selection.scene, entry.model, entry.file):
                raise ValueError("the name says another target, scene, model or file")
        except (ValueError, InputError) as error:
            raise InputError(f"{path}: kernels.{index}.kernel: {error}; {cure}") from None
    return selection


def files_of(selection: Selection) -> dict[str, str]:
    """Names and texts of all files of a folder, selection.json included."""
    files = {FILE: selection.text()}
    for entry in selection.kernels:
        variant = variant_of(entry.kernel)
        source = emit(variant, grounds=entry.grounds)
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
    above = {path.parent for path in kept}
    found = [path for path in root.iterdir() if path not in above]
    found += [path for place in above for path in place.iterdir() if path not in kept]
    return sorted(found)


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
    return sorted(path.parent for path in root.glob(f"*/*/{FILE}"))


def differences(folder: Path) -> list[Difference]:
    """How a folder differs from what the sources give: file set and bytes."""
    selection = checked_selection(folder)
    if selection is None:
        raise InputError(f"{folder}: no {FILE}; make it with ./gen --target {folder.parent.name}")
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
