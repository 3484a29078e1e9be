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

from tests.support.installed import BUILD, ROOT, run, wheel

TESTS = ROOT / "tests" / "pooltool"
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
            try:
                run([*pip, "--disable-pip-version-check", "-r", REQUIREMENTS], timeout=400)
            except (AssertionError, subprocess.TimeoutExpired) as error:
                lines = str(error).splitlines()
                reason = next((line for line in lines if "ERROR" in line), lines[0])
                pytest.skip(f"pooltool cannot be installed here: {reason}")
            (folder / "made").touch()
        carom = (folder / "bin" / "pip", "install", "-q", "--no-deps", "--no-index", "--force")
        run([*carom, "--disable-pip-version-check", wheel()])
    return folder / "bin" / "python"


def pytest_there(*arguments: object) -> str:
    """Run pytest in that environment; what it prints."""
    command = [environment(), "-m", "pytest", "-q", "-s", "-p", "no:cacheprovider", *arguments]
    text = run(command, PYTHONPATH=str(TESTS), PYTHONDONTWRITEBYTECODE="")
    print(text)
    return text


@pytest.mark.parametrize("name", sorted(path.name for path in TESTS.glob("test_*.py")))
def test_with_the_real_pooltool(name) -> None:
    text = pytest_there("--rootdir", TESTS, "--confcutdir", TESTS, TESTS / name)
    assert re.search(r"\d+ passed", text)


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
