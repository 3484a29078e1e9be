"""The one Jinja2 environment: strict, and its templates beside the package or inside it."""

from __future__ import annotations

from contextvars import ContextVar
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template

from .accepts import Accepts

_USED: ContextVar[set[str] | None] = ContextVar("templates of the text under way", default=None)


def templates_folder() -> Path:
    """Where the templates lie: beside the package in a checkout, inside it when installed."""
    package = Path(__file__).parents[1]
    beside = package.parent / "templates"
    return beside if beside.is_dir() else package / "templates"


class _Noting(Environment):
    """Notes which templates a text is made from, whatever includes or imports them."""

    def get_template(self, name, parent=None, globals=None) -> Template:  # type: ignore[no-untyped-def]
        if (used := _USED.get()) is not None and isinstance(name, str):
            used.add(name)
        return super().get_template(name, parent, globals)


def rendered(template: str, **shown: object) -> tuple[str, frozenset[str]]:
    """A template filled, and the names of all templates that the text is made from."""
    used: set[str] = set()
    before = _USED.set(used)
    try:
        return environment().get_template(template).render(**shown), frozenset(used)
    finally:
        _USED.reset(before)


@cache
def environment() -> Environment:
    """Every template is read through it; a name that is not given is an error."""
    return _Noting(
        loader=FileSystemLoader(str(templates_folder())),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # C++, not HTML
        extensions=[Accepts],
    )
