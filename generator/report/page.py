"""The page: one HTML file with its style, its plots and its data inside; and the data beside it.

Every number is taken from the document by its JSON pointer, which stands beside it in the page, so
that page and data cannot differ; a test follows the pointers in a browser.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from functools import cache
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from ..emission.environment import templates_folder
from .data import Report
from .pictures import plots_of

SHOWN_VARIANTS = 250  # of each contest in the page's tables; all are in the data
NOTHING = "\u2013"
_THIN = "\u202f"


def _significant(value: float, digits: int) -> str:
    """Fixed notation with so many significant digits, thousands apart."""
    if value == 0:
        return "0"
    places = max(digits - 1 - math.floor(math.log10(abs(value))), 0)
    return f"{value:,.{places}f}".replace(",", _THIN)


_FORMATS = {
    "ns": lambda v: _significant(v, 4),
    "cycles": lambda v: _significant(v, 4),
    "ratio": lambda v: _significant(v, 4),
    "times": lambda v: _significant(v, 3),
    "error": lambda v: f"{v:.1e}" if v else "0",
    "count": lambda v: f"{v:,.0f}".replace(",", _THIN),
    "mean": lambda v: _significant(v, 3),
    "percent": lambda v: f"{100 * v:.1f}{_THIN}%",
}


def _at(document: Mapping[str, Any], pointer: str) -> Any:
    """The value that an RFC 6901 pointer names."""
    value: Any = document
    for part in pointer.split("/")[1:]:
        key = part.replace("~1", "/").replace("~0", "~")
        value = value[int(key)] if isinstance(value, list) else value[key]
    return value


class Numbers:
    """Prints the numbers of a document by their pointers."""

    def __init__(self, document: Mapping[str, Any]) -> None:
        self._document = document

    def __call__(self, kind: str, *path: object) -> Markup:
        """An element with the number, formatted as its kind is, and where it comes from.

        `path`: keys and indices, or tuples of them.
        """
        steps = (step for part in path for step in (part if isinstance(part, tuple) else (part,)))
        parts = (str(step).replace("~", "~0").replace("/", "~1") for step in steps)
        pointer = "/" + "/".join(parts)
        value = _at(self._document, pointer)
        at = escape(pointer)
        if value is None:
            return Markup('<span class="none" data-at="{}">{}</span>').format(at, NOTHING)
        text = _FORMATS[kind](value)
        return Markup('<data value="{}" data-at="{}">{}</data>').format(value, at, text)


@cache
def _environment() -> Environment:
    """HTML is escaped, unlike C++: an environment apart from that of the kernels."""
    return Environment(
        loader=FileSystemLoader(str(templates_folder() / "report")),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        autoescape=True,
    )


def json_of(report: Report) -> str:
    """The data as JSON, a text that may also stand inside a page's script element."""
    text = json.dumps(report.document(), allow_nan=False, separators=(",", ":"))
    return text.replace("</", "<\\/").replace("<!--", "<\\u0021--")


def render(report: Report) -> str:
    """The page as HTML."""
    document = report.document()
    template = _environment().get_template("page.html.j2")
    return template.render(
        r=report,
        d=document,
        num=Numbers(document),
        plots=plots_of(report),
        data=Markup(json_of(report)),  # noqa: S704 - json_of escapes what ends a script
        shown=SHOWN_VARIANTS,
    )
