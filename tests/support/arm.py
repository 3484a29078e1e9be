"""An AArch64 Python with NumPy, run by qemu: Debian's packages and a wheel, below build/."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from functools import cache
from pathlib import Path

import pytest
from filelock import FileLock

from tests.support.installed import BUILD, ROOT, run

VERSION = "{}.{}".format(*sys.version_info)
PACKAGES = [
    f"python{VERSION}-minimal",
    *(f"libpython{VERSION}-{part}" for part in ("minimal", "stdlib")),
    *("libexpat1", "zlib1g", "libffi8"),
]
LIBRARIES = Path("/usr/aarch64-linux-gnu")  # of the cross compiler's package
NUMPY = "numpy==2.3.5"


def _missing() -> str:
    tools = ("qemu-aarch64", "aarch64-linux-gnu-g++", "apt-get", "dpkg")
    return ", ".join(name for name in tools if shutil.which(name) is None)


def _packages(folder: Path) -> None:
    """Debian's packages, with lists and a cache of their own: the system's stay as they are."""
    for name in ("lists/partial", "cache/archives/partial", "debs"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    settings = {"Dir::State::lists": folder / "lists", "Dir::Cache": folder / "cache"}
    options = [f"-o{key}={value}" for key, value in settings.items()]
    options += ["-oAPT::Architectures::=arm64", "-oAPT::Sandbox::User=root"]
    run(["apt-get", "-qq", *options, "update"], timeout=900)
    names = [f"{name}:arm64" for name in PACKAGES]
    run(["env", "-C", folder / "debs", "apt-get", "-qq", *options, "download", *names], timeout=900)
    for package in (folder / "debs").glob("*.deb"):
        run(["dpkg", "-x", package, folder / "root"])


def _numpy(folder: Path) -> None:
    platforms = [f"--platform=manylinux_2_{minor}_aarch64" for minor in (27, 28)]
    options = ["-q", "--no-deps", "--only-binary=:all:", f"--python-version={VERSION}", *platforms]
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "download"]
    run([*pip, *options, NUMPY, "-d", folder / "numpy"], timeout=900)
    for wheel in (folder / "numpy").glob("*.whl"):
        zipfile.ZipFile(wheel).extractall(folder / "site")


@cache
def emulated_python() -> Path:
    """The folder of it; a skip that says why where it cannot be had."""
    if missing := _missing():
        pytest.skip(f"not here: {missing}")
    folder = BUILD / f"arm-{VERSION}"
    BUILD.mkdir(parents=True, exist_ok=True)
    with FileLock(BUILD / "arm.lock"):
        if not (folder / "made").exists():
            shutil.rmtree(folder, ignore_errors=True)
            try:
                _packages(folder)
                _numpy(folder)
            except (AssertionError, subprocess.TimeoutExpired) as error:
                pytest.skip(f"no Python {VERSION} for arm64 can be had here: {str(error)[-300:]}")
            (folder / "made").touch()
    return folder


def arm_wheel(out: Path, **defined: str) -> Path:
    """The wheel that tools/wheels.py makes, with few kernels."""
    options = [f"--define={name}={value}" for name, value in defined.items()]
    run([sys.executable, ROOT / "tools" / "wheels.py", "--out", out, "aarch64", *options])
    return next(out.glob("*.whl"))


def run_there(wheel: Path, folder: Path, program: str, *arguments: object) -> str:
    """What a program prints that imports carom from a wheel, which is unpacked into `folder`."""
    python = emulated_python()
    zipfile.ZipFile(wheel).extractall(folder)
    root = python / "root"
    places = [root / "lib/aarch64-linux-gnu", root / "usr/lib/aarch64-linux-gnu", LIBRARIES / "lib"]
    there = {
        "LD_LIBRARY_PATH": os.pathsep.join(map(str, places)),
        "PYTHONHOME": str(root / "usr"),
        "PYTHONPATH": os.pathsep.join([str(folder), str(python / "site")]),
    }
    sets = [word for key, value in there.items() for word in ("-E", f"{key}={value}")]
    command = ["qemu-aarch64", "-L", LIBRARIES, *sets, root / f"usr/bin/python{VERSION}"]
    return run([*command, "-c", program, *arguments], timeout=600)
