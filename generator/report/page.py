"""The page: one HTML file with its style, its plots and its data inside; and the data beside it.

Every number is taken from the document by its JSON pointer, which stands beside it in the page, so
that page and data cannot differ; a test follows the pointers in a browser.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from ..emission.environment import templates_folder
from .drawing import variables
from .known import Known
from .layout import Code, Number, Piece, Section
from .sections import calls, chosen, contests, effects, errors, growth, machine, modelled
from .sections import operations as run
from .sections import published as report

SCHEMA = 1
NOTHING = "\u2013"
_THIN = "\u202f"
SECTIONS: tuple[Callable[[Known], Section], ...] = (
    chosen.section,
    contests.section,
    errors.outputs,
    errors.worst,
    errors.kinds,
    effects.effects,
    growth.section,
    run.operations,
    run.sections,
    modelled.section,
    effects.compilers,
    run.misses,
    calls.calls,
    calls.cpus,
    report.section,
    machine.section,
)


def sections_of(known: Known) -> list[Section]:
    return [make(known) for make in SECTIONS]


def missing_of(sections: Sequence[Section]) -> dict[str, str]:
    """What is not known, and why."""
    return {what: reason for section in sections for what, reason in section.missing.items()}


def document_of(known: Known, sections: Sequence[Section]) -> dict[str, Any]:
    """The data of the page, as JSON can hold it: numbers that are not finite become null.

    Times are in ns for one collision, `ratio` is the time divided by that of `paper-initial` in the
    same rounds, errors are relative to |v1 - v2| before the collision. null: not known; `missing`
    says why, by the name of the section.
    """
    head = {
        "schema": SCHEMA,
        "title": f"Collision kernels for {known.target}",
        "scene": known.scene,
        "model": known.model,
        "made_at": known.made_at,
    }
    found = {key: value for section in sections for key, value in section.data.items()}
    return _plain({**head, **found, "missing": missing_of(sections)})  # type: ignore[no-any-return]


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else None
    return value


def json_of(document: Mapping[str, Any]) -> str:
    """The data as JSON, a text that may also stand inside a page's script element."""
    text = json.dumps(document, allow_nan=False, separators=(",", ":"))
    return text.replace("</", "<\\/").replace("<!--", "<\\u0021--")


def render(sections: Sequence[Section], document: Mapping[str, Any]) -> str:
    """The page as HTML."""
    empty: dict[str, list[Section]] = {}
    for section in sections:
        if not section.blocks:
            empty.setdefault(section.missing.get(section.id, "nothing to show"), []).append(section)
    return (
        _environment()
        .get_template("page.html.j2")
        .render(
            document=document,
            sections=[section for section in sections if section.blocks],
            empty=empty,
            show=lambda piece: _shown(document, piece),
            variables=Markup(variables()),  # noqa: S704 - our own colours
            markup=Markup,
            data=Markup(json_of(document)),  # noqa: S704 - json_of escapes what ends a script
        )
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
    )


def _shown(document: Mapping[str, Any], piece: Piece) -> Markup:
    """A text, a name that may be broken at its dots, or a number with where it comes from."""
    if isinstance(piece, Code):
        parts = Markup(".<wbr>").join(piece.code.split("."))
        return Markup("<code>{}</code>").format(parts)
    if isinstance(piece, Number):
        return _number(document, piece)
    return escape(piece)


def _number(document: Mapping[str, Any], number: Number) -> Markup:
    """An element with the number, formatted as it asks, and its JSON pointer (RFC 6901)."""
    value: Any = document
    for step in number.path:
        value = value[step]
    steps = (str(step).replace("~", "~0").replace("/", "~1") for step in number.path)
    pointer = "/" + "/".join(steps)
    if value is None:
        return Markup('<span class="none" data-at="{}">{}</span>').format(pointer, NOTHING)
    shown = _FORMATS[number.format](value)
    return Markup('<data value="{}" data-at="{}">{}</data>').format(value, pointer, shown)


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
    "times": lambda v: _significant(v, 3),
    "error": lambda v: f"{v:.1e}" if v else "0",
    "count": lambda v: f"{v:,.0f}".replace(",", _THIN),
    "mean": lambda v: _significant(v, 3),
    "percent": lambda v: f"{100 * v:.1f}{_THIN}%",
}
