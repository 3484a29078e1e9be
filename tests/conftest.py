"""Tests marked `long` run only when asked for: `pytest -m long`. `--host`: as if on another CPU."""

from __future__ import annotations

import platform

import pytest

from generator.targets import host
from tests.support.hosts import cpuinfo_of, machine_of, names


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--host", choices=names(), help="run as if on this CPU, which the real one must outdo"
    )


def pytest_configure(config: pytest.Config) -> None:
    if (name := config.getoption("--host")) is not None:
        assert machine_of(name) == platform.machine(), f"--host {name}: another architecture"
        host.CPUINFO = cpuinfo_of(name)
    config.addinivalue_line("markers", "long: minutes long; run by `pytest -m long`")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.option.markexpr:
        return
    long = [item for item in items if item.get_closest_marker("long")]
    if long:
        config.hook.pytest_deselected(items=long)
        items[:] = [item for item in items if item not in long]
