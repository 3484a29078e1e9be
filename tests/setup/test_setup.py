"""What ./gen sets up agrees with what the project says it needs."""

from __future__ import annotations

import os
import platform
import re
import resource
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def canonical(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def locked(name: str = "requirements.lock") -> dict[str, str]:
    """Versions of a lock file by name."""
    lines = (ROOT / name).read_text("utf-8").splitlines()
    pins = [line.split("==") for line in lines if line and not line.startswith("#")]
    return {canonical(name): version for name, version in pins}


def test_the_lock_holds_every_requirement_of_the_project():
    project, lock = PROJECT["project"], locked()
    extras = project["optional-dependencies"]
    wanted = project["dependencies"] + extras["gen"] + extras["dev"]
    for requirement in (*wanted, *PROJECT["build-system"]["requires"]):
        name, operator, version = re.fullmatch(r"([\w-]+)(==|>=)([\d.]+)", requirement).groups()
        pinned = lock[canonical(name)]
        assert pinned == version or operator == ">=", f"{requirement} is locked to {pinned}"


def test_what_shapes_bytes_is_pinned_wherever_it_is_named():
    extra = PROJECT["project"]["optional-dependencies"]["gen"]
    build = PROJECT["build-system"]["requires"]
    for name in ("clang-format", "jinja2", "sympy"):
        for place in (extra, build):
            assert any(pin.startswith(f"{name}==") for pin in place), f"{name} in {place}"


def test_the_lock_of_the_cluster_extra_holds_its_pins_and_nothing_that_the_other_has():
    extra, lock = locked("requirements-cluster.lock"), locked()
    for pin in PROJECT["project"]["optional-dependencies"]["cluster"]:
        name, version = pin.split("==")
        assert extra[canonical(name)] == version
    assert not extra.keys() & lock.keys()


# ---- system packages: what a command needs, and no more ------------------------------------------

SETUP = """
set -euo pipefail
root=$1; shift
source "$root/tools/setup.sh"
carom_choose "$@"
carom_system have-python
"""
FROM_THE_SYSTEM = ("sed", "uname", "env", "mktemp", "grep", "tail", "rm", "touch", "chmod")
# It "installs" a program for a package, so that the set-up finds all that it asked for.
APT_GET = """#!/bin/bash
echo "$@" >>"$FAKES/log"
for word in "$@"; do
  case $word in
    cmake) name=cmake ;;
    ninja-build) name=ninja ;;
    g++) name=g++ ;;
    *) continue ;;
  esac
  touch "$FAKES/$name" && chmod +x "$FAKES/$name"
done
"""


def set_up(folder: Path, *arguments: str, **variables: str) -> tuple[int, set[str], str]:
    """Exit status, the packages that were to be installed, and standard error, where only the
    tools of a bare system are there."""
    fakes = folder / "bin"
    fakes.mkdir()
    for name in FROM_THE_SYSTEM:
        (fakes / name).symlink_to(shutil.which(name))
    (fakes / "apt-get").write_text(APT_GET)
    (fakes / "apt-cache").write_text("#!/bin/bash\necho known\n")
    for name in ("apt-get", "apt-cache"):
        (fakes / name).chmod(0o755)
    done = subprocess.run(
        [shutil.which("bash"), "-c", SETUP, "set-up", str(ROOT), *arguments],
        env={"PATH": str(fakes), "FAKES": str(fakes), "TMPDIR": str(folder), **variables},
        capture_output=True,
        text=True,
        check=False,
    )
    log = fakes / "log"
    asked = log.read_text().splitlines() if log.exists() else []
    packages = {word for line in asked if " install " in line for word in line.split()}
    known = {line.split(":")[1] for line in NEEDS}
    print(done.stderr)
    return done.returncode, packages & known, done.stderr


NEEDS = re.findall(r'^  "([^"]+)"$', (ROOT / "tools" / "setup.sh").read_text(), re.MULTILINE)
FOREIGN = {"g++-aarch64-linux-gnu", "qemu-user"}
OTHERS = {"chromium-headless-shell", "nodejs", "lld-19", "libgtest-dev"}
needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="apt-get is for root alone")


@needs_root
@pytest.mark.parametrize(
    "words",
    [
        "",
        "--help",
        "--version",
        "--check",
        "list targets",
        "explain paper-best",
        "emit x.cpp",
        "collide --help",
        "report --out x.html",
        "results merge a b --out c",
    ],
)
def test_what_builds_no_kernel_installs_no_system_package(words, tmp_path):
    assert set_up(tmp_path, *words.split())[:2] == (0, set())


@needs_root
@pytest.mark.parametrize(
    "words", ["--target native", "collide --cases a --out b", "sweep", "list scenes --cost"]
)
def test_what_builds_kernels_installs_compilers_and_no_browser_or_emulator(words, tmp_path):
    status, packages, _ = set_up(tmp_path, *words.split())
    assert status == 0 and {"g++", "cmake", "ninja-build"} <= packages
    assert not packages & (FOREIGN | OTHERS | {"valgrind"})


@needs_root
def test_code_for_another_architecture_brings_its_compiler_and_emulator(tmp_path):
    arch = "x86-64-v2" if platform.machine() == "aarch64" else "neoverse-n1"
    status, packages, _ = set_up(tmp_path, "vendor", "--target", f"zen3,{arch}", "--out", "x")
    assert status == 0 and packages >= FOREIGN and not packages & OTHERS


def test_a_variable_keeps_apt_away_and_the_error_names_it(tmp_path):
    status, packages, said = set_up(tmp_path, "--target", "native", CAROM_NO_APT="1")
    assert (status, packages) == (2, set())
    line = next(each for each in said.splitlines() if "missing: cmake" in each)
    assert "g++" in line and "apt-get install" in line and "CAROM_NO_APT" in line
    (tmp_path / "again").mkdir()
    assert set_up(tmp_path / "again", "list", "scenes", CAROM_NO_APT="1")[0] == 0


def test_import_generator_pulls_in_nothing_and_help_takes_little():
    """`gen --help` takes 0.3 s of an idle CPU at most; a loaded one counts more for the same."""
    code = "import generator, sys; print('sympy' in sys.modules, 'numpy' in sys.modules)"
    run = [sys.executable, "-P", "-c", code]
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(run, env=env, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]
    took = []
    for _ in range(5):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [sys.executable, "-P", "-m", "generator", "--help"],
            env=env,
            stdout=subprocess.DEVNULL,
            check=True,
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        took.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    print(took)
    assert min(took) < 0.3
