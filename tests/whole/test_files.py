"""The one writer of files: links, devices, fifos, modes, and what is refused with nothing lost."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import threading
from contextlib import contextmanager
from pathlib import Path

import pytest
from click.testing import CliRunner

from generator.cli.main import gen
from generator.errors import InputError
from generator.files import require_place, write_file
from generator.sweep.store import opened
from generator.vendoring.folder import require_replaceable, staged, write_files
from tests.support.installed import ROOT
from tests.support.reference import FOLDER

AS_ROOT = pytest.mark.skipif(os.geteuid() != 0, reason="only root makes devices and gives owners")
NOBODY = 65534


def mode(path: Path) -> str:
    return f"{stat.S_IMODE(path.stat().st_mode):04o}"


@contextmanager
def masked(mask: int):
    before = os.umask(mask)
    try:
        yield
    finally:
        os.umask(before)


def refused(path: Path, *parts: str, write=write_file) -> None:
    """One line that names the path and the parts; no file beside it is left or lost."""
    here = path.parent if path.parent.is_dir() else path.parent.parent
    before = {p.name: p.lstat().st_mtime_ns for p in here.iterdir()}
    with pytest.raises(InputError) as caught:
        write(path, "new") if write is write_file else write(path)
    text = str(caught.value)
    print(text)
    assert "\n" not in text and str(path) in text
    assert all(part in text for part in parts), text
    assert {p.name: p.lstat().st_mtime_ns for p in here.iterdir()} == before


@pytest.mark.parametrize(("mask", "want"), [(0o022, "0644"), (0o077, "0600"), (0, "0666")])
def test_a_new_file_gets_what_the_umask_leaves(mask, want, tmp_path) -> None:
    with masked(mask):
        write_file(tmp_path / "new", "text")
    print(f"umask {mask:04o}: mode {mode(tmp_path / 'new')}")
    assert mode(tmp_path / "new") == want
    assert [p.name for p in tmp_path.iterdir()] == ["new"]


@pytest.mark.parametrize("was", [0o600, 0o640, 0o755, 0o666])
def test_an_old_file_keeps_its_mode(was, tmp_path) -> None:
    path = tmp_path / "old"
    path.write_text("old")
    path.chmod(was)
    write_file(path, "new")
    assert (path.read_text(), mode(path)) == ("new", f"{was:04o}")


@AS_ROOT
def test_an_old_file_keeps_its_owner(tmp_path) -> None:
    path = tmp_path / "old"
    path.write_text("old")
    os.chown(path, NOBODY, NOBODY)
    path.chmod(0o640)
    write_file(path, "new")
    kept = path.stat()
    assert (path.read_text(), kept.st_uid, kept.st_gid, mode(path)) == ("new", 65534, 65534, "0640")


def test_links_are_followed_and_stay(tmp_path) -> None:
    """Relative, absolute, chained, through a linked folder, and one that leads to nothing."""
    (tmp_path / "far").mkdir()
    (tmp_path / "near").symlink_to("far")
    (tmp_path / "far" / "file").write_text("old")
    (tmp_path / "one").symlink_to("near/file")
    (tmp_path / "two").symlink_to(tmp_path / "one")
    (tmp_path / "dangling").symlink_to("far/made")
    write_file(tmp_path / "two", "new")
    write_file(tmp_path / "dangling", "made")
    assert (tmp_path / "far" / "file").read_text() == "new"
    assert (tmp_path / "far" / "made").read_text() == "made"
    assert all((tmp_path / name).is_symlink() for name in ("near", "one", "two", "dangling"))
    (tmp_path / "round").symlink_to("round")
    refused(tmp_path / "round", "symbolic links")


def test_a_fifo_is_written_through(tmp_path) -> None:
    path, got = tmp_path / "fifo", []
    os.mkfifo(path)
    reader = threading.Thread(target=lambda: got.append(path.read_text()))
    reader.start()
    write_file(path, "through")
    reader.join(10)
    assert got == ["through"] and stat.S_ISFIFO(path.stat().st_mode)


@AS_ROOT
def test_a_device_stays_a_device(tmp_path) -> None:
    for name, minor in (("null", 3), ("full", 7)):
        os.mknod(tmp_path / name, stat.S_IFCHR | 0o666, os.makedev(1, minor))
    (tmp_path / "link").symlink_to("null")
    write_file(tmp_path / "null", "gone")
    write_file(tmp_path / "link", "gone")
    refused(tmp_path / "full", "No space left on device")
    assert all(stat.S_ISCHR((tmp_path / n).stat().st_mode) for n in ("null", "full"))


def test_dev_null_and_full_stay_devices_whoever_writes() -> None:
    write_file(Path("/dev/null"), "gone")
    with pytest.raises(InputError, match="/dev/full: cannot be written: No space"):
        write_file(Path("/dev/full"), "new")
    assert all(stat.S_ISCHR(Path(p).stat().st_mode) for p in ("/dev/null", "/dev/full"))


def through_stdout(target: Path | None, code: str) -> str:
    """What a Python that is given a file or a pipe as standard output leaves in it."""
    command = [sys.executable, "-c", f"import sys; from generator.files import *; {code}"]
    if target is None:
        return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    with target.open("w") as file:
        subprocess.run(command, cwd=ROOT, check=True, stdout=file)
    return target.read_text()


@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "link"])
def test_standard_output_is_written_in_its_order_to_files_and_pipes(name, tmp_path) -> None:
    """Neither replaced nor written over from the start."""
    if name == "link":
        (tmp_path / name).symlink_to("/dev/stdout")
        name = str(tmp_path / name)
    code = f"print('a'); write_file(Path({name!r}), 'b\\n'); print('c')"
    for target in (tmp_path / "out", None):
        assert through_stdout(target, code) == "a\nb\nc\n"


def test_what_is_open_for_reading_alone_is_refused(tmp_path) -> None:
    with (tmp_path / "file").open("w") as made:
        made.write("old")
    with (tmp_path / "file").open() as reading:
        path = Path(f"/dev/fd/{reading.fileno()}")
        with pytest.raises(InputError, match="open for reading alone"):
            write_file(path, "new")
    assert (tmp_path / "file").read_text() == "old"


@pytest.mark.parametrize("write", [write_file, require_place])
def test_what_cannot_be_written_is_refused_before_the_work_and_when_it_is_done(
    write, tmp_path
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("old")
    (tmp_path / "file").chmod(0o444)
    (tmp_path / "linked").symlink_to("file")
    refused(tmp_path / "folder", "is a folder", write=write)
    refused(tmp_path / "file", "read-only (mode 0444)", "name another", write=write)
    refused(tmp_path / "linked", "read-only (mode 0444)", write=write)
    refused(tmp_path / "none" / "file", "there is no folder", "make it first", write=write)
    refused(tmp_path / "file" / "file", "file", write=write)
    refused(tmp_path / ("x" * 300), "name too long", write=write)
    assert (tmp_path / "file").read_text() == "old"


def test_a_name_as_long_as_names_may_be_is_written(tmp_path) -> None:
    write_file(tmp_path / ("x" * 255), "text")
    assert (tmp_path / ("x" * 255)).read_text() == "text"


def test_no_space_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch) -> None:
    (tmp_path / "file").write_text("old")

    def full(_handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    refused(tmp_path / "file", "No space left on device")
    assert (tmp_path / "file").read_text() == "old"


def test_a_vendored_folder_gets_the_umask_keeps_its_mode_and_its_link(tmp_path) -> None:
    (tmp_path / "link").symlink_to("carom")
    with masked(0o027):
        for count in range(2):
            require_replaceable(tmp_path / "link", edited_too=True) if not count else None
            with staged(tmp_path / "link") as folder:
                write_files(folder, {"carom.h": f"{count}"})
            assert mode(tmp_path / "carom") == ("0750", "0700")[count]
            assert mode(tmp_path / "carom" / "carom.h") == "0640"
            (tmp_path / "carom").chmod(0o700)
    assert (tmp_path / "link").is_symlink() and (tmp_path / "carom" / "carom.h").read_text() == "1"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["carom", "link"]


def test_the_store_of_a_sweep_is_a_regular_file_that_may_be_written(tmp_path) -> None:
    def store(path: Path) -> None:
        with opened(path):
            pass

    (tmp_path / "folder").mkdir()
    store(tmp_path / "a.sqlite")
    (tmp_path / "a.sqlite").chmod(0o444)
    os.mkfifo(tmp_path / "fifo")
    refused(tmp_path / "folder", "is a folder", write=store)
    refused(tmp_path / "a.sqlite", "read-only", write=store)
    refused(tmp_path / "fifo", "expected a regular file", write=store)
    with pytest.raises(InputError, match="/dev/null: is a device"):
        store(Path("/dev/null"))


def test_collide_writes_to_standard_output_what_it_writes_to_a_file(tmp_path) -> None:
    cases = tmp_path / "cases.csv"
    cases.write_text("".join((FOLDER / "inputs.csv").open().readlines()[:4]))
    out = tmp_path / "out.csv"
    options = ["collide", "--target", "x86-64-v2", "--cases", str(cases), "--out"]
    told = CliRunner().invoke(gen, [*options, str(out)])
    assert told.exit_code == 0, told.stderr
    command = [sys.executable, "-P", "-m", "generator", *options, "/dev/stdout"]
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=env)
    assert done.returncode == 0, done.stderr
    assert done.stdout == out.read_text() and "3 cases, 3 collided" in done.stderr
