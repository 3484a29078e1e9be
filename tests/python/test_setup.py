"""What ./gen sets up agrees with what the project says it needs."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

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
    wanted = project["dependencies"] + project["optional-dependencies"]["dev"]
    for requirement in (*wanted, *PROJECT["build-system"]["requires"]):
        name, operator, version = re.fullmatch(r"([\w-]+)(==|>=)([\d.]+)", requirement).groups()
        pinned = lock[canonical(name)]
        assert pinned == version or operator == ">=", f"{requirement} is locked to {pinned}"


def test_what_shapes_bytes_is_pinned_wherever_it_is_named():
    project, build = PROJECT["project"]["dependencies"], PROJECT["build-system"]["requires"]
    for name in ("clang-format", "jinja2", "sympy"):
        for place in (project, build):
            assert any(pin.startswith(f"{name}==") for pin in place), f"{name} in {place}"


def test_the_lock_of_the_cluster_extra_holds_its_pins_and_nothing_that_the_other_has():
    extra, lock = locked("requirements-cluster.lock"), locked()
    for pin in PROJECT["project"]["optional-dependencies"]["cluster"]:
        name, version = pin.split("==")
        assert extra[canonical(name)] == version
    assert not extra.keys() & lock.keys()
