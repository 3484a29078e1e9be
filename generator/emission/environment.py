"""The one Jinja2 environment: strict, and its templates beside the package or inside it."""

from __future__ import annotations

from functools import cache
from importlib import resources
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined


def templates_folder() -> Path:
    """Where the templates lie: beside the package in a checkout, inside it when installed."""
    package = Path(str(resources.files("generator")))
    beside = package.parent / "templates"
    return beside if beside.is_dir() else package / "templates"


@cache
def environment() -> Environment:
    """Every template is read through it; a name that is not given is an error."""
    return Environment(
        loader=FileSystemLoader(str(templates_folder())),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # noqa: S701 - C++, not HTML
        extensions=[],
    )
