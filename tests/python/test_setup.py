"""What ./gen sets up agrees with what the project says it needs."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def canonical(pin: str) -> str:
    return re.sub(r"[-_.]+", "-", pin.split("==")[0]).lower() + "==" + pin.split("==")[1]


def test_the_lock_holds_every_pin_of_the_project():
    lines = (ROOT / "requirements.lock").read_text("utf-8").splitlines()
    lock = {canonical(line) for line in lines if line and not line.startswith("#")}
    wanted = PROJECT["project"]["dependencies"] + PROJECT["project"]["optional-dependencies"]["dev"]
    assert {canonical(pin) for pin in wanted} <= lock


def test_the_lock_of_the_cluster_extra_holds_its_pins_and_nothing_that_the_other_has():
    extra, lock = (
        {
            canonical(line)
            for line in (ROOT / name).read_text("utf-8").splitlines()
            if line and not line.startswith("#")
        }
        for name in ("requirements-cluster.lock", "requirements.lock")
    )
    wanted = PROJECT["project"]["optional-dependencies"]["cluster"]
    assert {canonical(pin) for pin in wanted} <= extra
    assert not {pin.split("==")[0] for pin in extra} & {pin.split("==")[0] for pin in lock}


def test_every_room_is_packaged():
    rooms = {
        ".".join(path.parent.relative_to(ROOT).parts)
        for path in (ROOT / "generator").rglob("__init__.py")
    }
    assert set(PROJECT["tool"]["setuptools"]["packages"]) >= rooms
