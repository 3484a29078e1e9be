"""Other people's accounts: their variables, homes, clones and disks. One line, exit 2, the cure."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from generator.errors import InputError
from generator.files import require_cache
from generator.places import cache_folder
from tests.support.installed import ROOT

NOBODY = 65534
AS_ROOT = pytest.mark.skipif(os.geteuid() != 0, reason="only root can be another user or mount")
DOTTED = "carom_probe-1-py3-none-any.whl"


def environment(**variables: str) -> dict[str, str]:
    """This process's, without what the test run's own account may have set."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("PIP_", "PYTHON", "CAROM_"))}
    return {**kept, **variables}


def one_line(done: subprocess.CompletedProcess, *parts: str) -> None:
    told = [line for line in done.stderr.splitlines() if line and "carom: building" not in line]
    print(*told, sep="\n")
    assert done.returncode == 2, (done.returncode, done.stdout, done.stderr)
    assert told and "Traceback" not in done.stderr
    assert all(part in told[-1] for part in parts), told[-1]
    assert sum("gen: " in line for line in told) <= 1


# ---- the first use -----------------------------------------------------------------------------


def wheel(folder: Path) -> Path:
    """A package that takes no build and no network."""
    folder.mkdir()
    with zipfile.ZipFile(folder / DOTTED, "w") as made:
        made.writestr("carom_probe.py", "HERE = 1\n")
        info = "carom_probe-1.dist-info"
        made.writestr(f"{info}/METADATA", "Metadata-Version: 2.1\nName: carom-probe\nVersion: 1\n")
        made.writestr(
            f"{info}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
        )
        made.writestr(f"{info}/RECORD", "")
    return folder


def clone(place: Path) -> Path:
    """As much of a clone as ./gen needs to set it up; its generator says whose packages it has."""
    (place / "tools").mkdir(parents=True)
    (place / "generator").mkdir()
    shutil.copy2(ROOT / "gen", place)
    shutil.copy2(ROOT / "tools" / "setup.sh", place / "tools")
    (place / "requirements.lock").write_text("carom-probe==1\n")
    (place / "generator" / "__main__.py").write_text(
        "import carom_probe; print(carom_probe.__file__)\n"
    )
    return place


def first_use(
    place: Path, user: int | None = None, **variables: str
) -> subprocess.CompletedProcess:
    return subprocess.run(
        [place / "gen"],
        env=environment(**variables),
        capture_output=True,
        text=True,
        check=False,
        timeout=900,
        user=user,
        group=user,
    )


def test_the_first_use_takes_the_network_settings_of_pip_alone(tmp_path) -> None:
    """Its variables and its configuration, in a folder with blanks and letters beyond ASCII."""
    place = clone(tmp_path / "a clone ü")
    config = tmp_path / "pip.conf"
    config.write_text(
        f"[global]\nno-index = true\nfind-links =\n  {wheel(tmp_path / 'links')}\n  /none\n"
        f"[install]\nuser = true\ntarget = {tmp_path / 'elsewhere'}\nrequire-hashes = true\n"
    )
    hostile = {
        **{f"PIP_{name}": "1" for name in ("USER", "REQUIRE_HASHES", "DRY_RUN", "NO_DEPS")},
        **{f"PIP_{name}": str(tmp_path / name) for name in ("TARGET", "PREFIX", "ROOT", "PYTHON")},
        "PIP_CONFIG_FILE": str(config),
        "PYTHONHOME": "/none",
        "PYTHONPATH": "/none",
        "PYTHONSTARTUP": "/none",
        "PYTHONUSERBASE": "/none",
        "CDPATH": "/tmp:/",
        "LC_ALL": "xx_YY.odd",
        "XDG_CACHE_HOME": "relative",
        "HOME": "/dev/null/none",
    }
    done = first_use(place, **hostile)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(str(place / ".venv")), done.stdout
    assert not (tmp_path / "elsewhere").exists() and not (tmp_path / "TARGET").exists()
    again = first_use(place)
    assert (again.stdout, again.returncode) == (done.stdout, 0)
    assert "installing" in done.stderr and "installing" not in again.stderr


def test_a_failure_of_pip_is_one_line_with_its_cause(tmp_path) -> None:
    done = first_use(clone(tmp_path / "clone"), PIP_NO_INDEX="1")
    one_line(done, "carom-probe==1", "(log: ")


@pytest.mark.parametrize(
    ("variables", "parts"),
    [
        ({"TMPDIR": "/none"}, ("TMPDIR=/none", "unset it")),
        ({"TMPDIR": "/dev/null"}, ("TMPDIR=/dev/null", "unset it")),
    ],
)
def test_variables_that_name_nothing_are_told(variables, parts, tmp_path) -> None:
    one_line(first_use(clone(tmp_path / "clone"), **variables), *parts)


@pytest.mark.parametrize("name", ["a:b", "a\nb"])
def test_a_folder_that_no_path_variable_can_name_is_told(name, tmp_path) -> None:
    done = first_use(clone(tmp_path / name))
    assert done.returncode == 2 and "move the clone to another folder" in done.stderr


@AS_ROOT
def test_a_clone_of_another_user_is_told_who_may_set_it_up(tmp_path) -> None:
    for folder in (tmp_path, *tmp_path.parents[:3]):
        folder.chmod(folder.stat().st_mode | 0o055) if folder != Path("/tmp") else None
    place = clone(tmp_path / "clone")
    one_line(first_use(place, user=NOBODY), "is not set up, and nobody", "(root)", "./gen list")
    (place / ".venv").mkdir(mode=0o700)
    one_line(first_use(place, user=NOBODY), ".venv is out of date or cannot be read", "(root)")


# ---- caches --------------------------------------------------------------------------------------


def collide(
    user: int | None = None, before: str = "", **variables: str
) -> subprocess.CompletedProcess:
    """gen collide of this clone, in a shell of its own; `before`: what that does first."""
    cases = ROOT / "tests" / "data" / "reference" / "inputs.csv"
    python = f"{sys.executable} -P -m generator"
    script = f"{before} {python} collide --cases {cases} --out /dev/null"
    return subprocess.run(
        ["bash", "-c", script],
        env=environment(PYTHONPATH=str(ROOT), **variables),
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
        user=user,
        group=user,
    )


def test_a_cache_that_cannot_be_is_told_with_its_cure() -> None:
    one_line(
        collide(CAROM_CACHE="/dev/null/x"), "cache /dev/null/x: Not a directory", "CAROM_CACHE"
    )
    one_line(collide(CAROM_CACHE="/dev/null"), "cache /dev/null: File exists", "CAROM_CACHE")
    one_line(collide(TMPDIR="/none"), "TMPDIR=/none", "unset it")


@AS_ROOT
@pytest.mark.parametrize(
    ("options", "part"),
    [("noexec", "no program can be run there"), ("size=64k", "No space left on device")],
)
def test_a_cache_on_a_disk_that_is_full_or_noexec_is_told(options, part, tmp_path) -> None:
    mounted = f"mount -t tmpfs -o {options} carom {tmp_path} &&"
    tried = subprocess.run(["unshare", "-m", "true"], check=False, capture_output=True)
    if tried.returncode:
        pytest.skip("mounts are not allowed here")
    command = f'unshare -m bash -c \'{mounted} "$0" "$@"\''
    one_line(collide(before=command, CAROM_CACHE=str(tmp_path / "c")), part, "set CAROM_CACHE to")


@AS_ROOT
def test_another_user_of_a_clone_that_is_set_up_has_a_cache_of_his_own() -> None:
    """Without a home he is told what to set; nothing of the clone is written."""
    reads = [sys.executable, "-c", f"open({str(ROOT / 'gen')!r})"]
    if subprocess.run(["env", *reads], user=NOBODY, check=False, capture_output=True).returncode:
        pytest.skip("another user cannot run this Python, or read this clone's folder")
    told = collide(user=NOBODY, HOME="/nonexistent")
    one_line(told, "cache /nonexistent/.cache/carom: ", "set CAROM_CACHE to")


def test_the_cache_is_in_the_clone_else_at_home_as_its_specification_says(
    tmp_path, monkeypatch
) -> None:
    for name in ("CAROM_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    assert cache_folder() == ROOT / "build" / "cache"
    monkeypatch.setattr("generator.places.checkout", lambda: None)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_folder() == tmp_path / ".cache" / "carom"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert cache_folder() == tmp_path / ".cache" / "carom"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache_folder() == tmp_path / "xdg" / "carom"
    require_cache(cache_folder())
    assert list((tmp_path / "xdg" / "carom").iterdir()) == []
    monkeypatch.delenv("XDG_CACHE_HOME")

    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", homeless)
    with pytest.raises(InputError, match=r"there is no home folder.*CAROM_CACHE"):
        cache_folder()


# ---- anywhere ------------------------------------------------------------------------------------


def test_a_full_standard_output_is_one_line() -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-P", "-m", "generator", "list", "targets"],
            env=environment(PYTHONPATH=str(ROOT)),
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    print(done.stderr)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1
    assert done.stderr.startswith("gen: No space left on device")


def test_a_name_that_is_no_text_is_told_in_any_encoding() -> None:
    command = [sys.executable, "-P", "-m", "generator", "collide", "--out", "/dev/null", "--cases"]
    for encoding in ("utf-8", "ascii"):
        done = subprocess.run(
            [*command, b"/none/\xff\xc3\xbc.csv"],
            env=environment(PYTHONPATH=str(ROOT), PYTHONIOENCODING=encoding),
            capture_output=True,
            text=True,
            check=False,
        )
        one_line(done, "No such file", "/none/")
