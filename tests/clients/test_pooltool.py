"""The real pooltool with our class in place of its own, in an environment of its own."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest
from filelock import FileLock

from tests.support.installed import BUILD, ROOT, run, site, wheel

TESTS = ROOT / "tests" / "pooltool"
OTHER = "0.5.0"  # the other release that carom.pooltool is for
REQUIREMENTS = TESTS / "requirements.txt"


@cache
def environment() -> Path:
    """Its python, made with pip; a skip that says why where it cannot be had."""
    key = hashlib.sha256(REQUIREMENTS.read_bytes()).hexdigest()[:12]
    folder = BUILD / f"pooltool-{key}"
    BUILD.mkdir(parents=True, exist_ok=True)
    with FileLock(BUILD / "pooltool.lock"):
        if not (folder / "made").exists():
            shutil.rmtree(folder, ignore_errors=True)
            run([sys.executable, "-m", "venv", folder])
            pip = [folder / "bin" / "pip", "install", "-q", "--no-input", "--no-deps"]
            pip += ["--no-compile", "--disable-pip-version-check"]  # few of its modules are used
            try:
                run([*pip, "-r", REQUIREMENTS], timeout=1500)
            except (AssertionError, subprocess.TimeoutExpired) as error:
                lines = str(error).splitlines()
                reason = next((line for line in lines if "ERROR" in line), lines[0])
                pytest.skip(f"pooltool cannot be installed here: {reason}")
            (folder / "made").touch()
        carom = (folder / "bin" / "pip", "install", "-q", "--no-deps", "--no-index", "--force")
        run([*carom, "--disable-pip-version-check", wheel()])
    return folder / "bin" / "python"


@cache
def other_release() -> Path:
    """A folder with the older release alone; a skip that says why where it cannot be had."""
    python = environment()
    folder = BUILD / f"pooltool-{OTHER}"
    with FileLock(BUILD / "pooltool.lock"):
        if not folder.is_dir():
            command = [python, "-m", "pip", "install", "-q", "--no-input", "--no-deps", "--target"]
            try:
                run([*command, folder, f"pooltool-billiards=={OTHER}"], timeout=1500)
            except (AssertionError, subprocess.TimeoutExpired) as error:
                shutil.rmtree(folder, ignore_errors=True)
                pytest.skip(f"pooltool {OTHER} cannot be installed here: {error}")
    return folder


def head() -> Path:
    """A checkout of the development head, which no registry has."""
    if source := os.environ.get("CAROM_POOLTOOL_HEAD"):
        return Path(source)
    pytest.skip("CAROM_POOLTOOL_HEAD names no checkout of pooltool's development head")


RELEASES = {"0.6.0": lambda: TESTS, OTHER: other_release, "head": head}


def pytest_there(*arguments: object, before: Path = TESTS) -> str:
    """Run pytest in that environment, with a folder before its packages; what it prints.

    Each release has a home of its own: what one keeps there another cannot read.
    """
    home = BUILD / f"home-{before.name}"
    home.mkdir(parents=True, exist_ok=True)
    command = [environment(), "-m", "pytest", "-q", "-s", "-p", "no:cacheprovider", *arguments]
    text = run(command, PYTHONPATH=f"{before}:{TESTS}", HOME=str(home), PYTHONDONTWRITEBYTECODE="")
    print(text)
    return text


@pytest.mark.parametrize("release", RELEASES)
@pytest.mark.parametrize("name", sorted(path.name for path in TESTS.glob("test_*.py")))
def test_with_the_real_pooltool(name, release) -> None:
    text = pytest_there(
        "--rootdir", TESTS, "--confcutdir", TESTS, TESTS / name, before=RELEASES[release]()
    )
    assert re.search(r"\d+ passed", text)


UNFIT = """
import importlib.metadata, sys
known = importlib.metadata.version
def version(name):
    if name == "pooltool-billiards" and sys.argv[1] == "none":
        raise importlib.metadata.PackageNotFoundError(name)
    return sys.argv[1] if name == "pooltool-billiards" else known(name)
importlib.metadata.version = version
sys.modules["pooltool"] = None
try:
    import carom.pooltool
except ImportError as error:
    print(error)
"""


@pytest.mark.parametrize("release", ["0.4.4", "0.7.0", "none"])
def test_another_release_is_refused_with_the_range(release: str) -> None:
    told = run([sys.executable, "-P", "-c", UNFIT, release], PYTHONPATH=str(site())).strip()
    print(told)
    assert f"expected pooltool-billiards from 0.5.0 to 0.6.x; there is {release}" in told


def test_its_own_ball_ball_tests_pass_with_our_class() -> None:
    """Neither its wheel nor its sdist holds them: CAROM_POOLTOOL_SOURCE names a checkout."""
    source = os.environ.get("CAROM_POOLTOOL_SOURCE")
    if not source:
        pytest.skip(
            "CAROM_POOLTOOL_SOURCE names no checkout of pooltool 0.6.0: its tests are in its "
            "repository alone, neither in its wheel nor in its sdist"
        )
    theirs = Path(source) / "tests" / "physics" / "resolve" / "ball_ball"
    # -v takes -q back: with it pytest leaves its header out.
    text = pytest_there("-v", "-p", "ours_for_theirs", "--rootdir", source, theirs)
    assert "FrictionalMathavan is that of carom.pooltool" in text
    assert re.search(r"\d{3} passed", text) and "failed" not in text
