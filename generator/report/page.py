"""The page: one HTML file with its style, its plots and its data inside; and the data beside it.

Every number is taken from the document by its JSON pointer, which stands beside it in the page, so
that page and data cannot differ; a test follows the pointers in a browser.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from ..emission.accepts import Accepts
from ..emission.environment import templates_folder
from .drawing import variables
from .plots import Plot

NOTHING = "\u2013"
SHOWN_VARIANTS = 250  # of each contest in the page's tables; all are in the data
_THIN = "\u202f"
Column = tuple[str, ...]  # a heading, a format, and the keys that lead from a row to its value


def json_of(document: Mapping[str, Any]) -> str:
    """The data as JSON, a text that may also stand inside a page's script element."""
    text = json.dumps(document, allow_nan=False, separators=(",", ":"))
    return text.replace("</", "<\\/").replace("<!--", "<\\u0021--")


def render(document: Mapping[str, Any], plots: Mapping[str, Sequence[Plot]]) -> str:
    """The page as HTML. `plots`: by the section that they stand in."""
    cells = Cells(document)
    page = _environment().get_template("page.html.j2")
    return page.render(
        d=document,
        num=cells.number,
        interval=cells.interval,
        code=code,
        table=cells.table,
        plots=plots,
        shown_variants=SHOWN_VARIANTS,
        variables=Markup(variables()),  # noqa: S704 - our own colours
        markup=Markup,
        data=Markup(json_of(document)),  # noqa: S704 - json_of escapes what ends a script
    )


@cache
def _environment() -> Environment:
    """HTML is escaped, unlike C++: an environment apart from that of the kernels."""
    return Environment(
        loader=FileSystemLoader(str(templates_folder() / "report")),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        autoescape=True,
        extensions=[Accepts],
    )


def code(name: str) -> Markup:
    """The name of a kernel or of an option, which may be broken at its dots."""
    return Markup("<code>{}</code>").format(Markup(".<wbr>").join(str(name).split(".")))


class Cells:
    """Prints what stands in a document, numbers by their pointers."""

    def __init__(self, document: Mapping[str, Any]) -> None:
        self._document = document

    def _at(self, path: Iterable[str | int]) -> Any:
        value: Any = self._document
        for step in path:
            value = value[step]
        return value

    def number(self, kind: str, *path: str | int) -> Markup:
        """An element with the number, formatted as its kind is, and its pointer (RFC 6901)."""
        value = self._at(path)
        steps = (str(step).replace("~", "~0").replace("/", "~1") for step in path)
        pointer = "/" + "/".join(steps)
        if value is None:
            return Markup('<span class="none" data-at="{}">{}</span>').format(pointer, NOTHING)
        shown = _FORMATS[kind](value)
        return Markup('<data value="{}" data-at="{}">{}</data>').format(value, pointer, shown)

    def interval(self, *path: str | int) -> Markup:
        low, high = (self.number("ratio", *path, end) for end in (0, 1))
        return Markup("{} to {}").format(low, high)

    def table(
        self,
        at: Sequence[str | int],
        columns: Sequence[Column],
        caption: str = "",
        groups: Sequence[tuple[str, int]] = (),
        rows: Iterable[int] | None = None,
    ) -> Markup:
        """A row for each record of the list at a path, or for those with the numbers `rows`.

        `groups`: texts above the heads, and how many columns each is wide.
        """
        numbers = range(len(self._at(at))) if rows is None else rows
        heads = [(head, kind in _FORMATS) for head, kind, *_ in columns]
        cells = [[self._cell((*at, n), *column[1:]) for column in columns] for n in numbers]
        table = _environment().get_template("table.html.j2")
        text = table.render(heads=heads, rows=cells, caption=caption, groups=groups)
        return Markup(text)  # noqa: S704 - escaped by the template

    def _cell(self, at: Sequence[str | int], kind: str, *path: str | int) -> Markup:
        """The value of a record; nothing where the record has no such entry."""
        place = (*at, *path)
        holder = self._at(place[:-1])
        if isinstance(holder, Mapping) and place[-1] not in holder:
            return Markup()
        if kind == "ratio_ci":
            shown = self.number("ratio", *place)
            ends = (*place[:-1], "ratio_ci")
            has = self._at(ends) is not None
            return Markup("{} ({})").format(shown, self.interval(*ends)) if has else shown
        if kind in _FORMATS:
            return self.number(kind, *place)
        value = holder[place[-1]]
        if kind == "pairs":
            each = (
                Markup("{}\u00a0{}").format(key, self.number("mean", *place, key)) for key in value
            )
            return Markup(", ").join(each)
        if kind == "code":
            names = [value] if isinstance(value, str) else value
            return Markup(" ").join(code(name) for name in names)
        return escape(value)


def _significant(value: float, digits: int) -> str:
    """Fixed notation with so many significant digits, thousands apart."""
    if value == 0:
        return "0"
    places = max(digits - 1 - math.floor(math.log10(abs(value))), 0)
    return f"{value:,.{places}f}".replace(",", _THIN)


_FORMATS: dict[str, Callable[[float], str]] = {
    "ns": lambda v: _significant(v, 4),
    "cycles": lambda v: _significant(v, 4),
    "ratio": lambda v: _significant(v, 4),
    "ratio_ci": lambda v: _significant(v, 4),
    "times": lambda v: _significant(v, 3),
    "error": lambda v: f"{v:.1e}" if v else "0",
    "count": lambda v: f"{v:,.0f}".replace(",", _THIN),
    "mean": lambda v: _significant(v, 3),
    "percent": lambda v: f"{100 * v:.1f}{_THIN}%",
}
