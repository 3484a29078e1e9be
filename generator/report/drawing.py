"""The one way to draw: matplotlib's SVG, with CSS variables for colours, light and dark.

The same figure gives the same bytes: no date, no version, no random ids.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

# By the name of a CSS variable, on light and on dark pages. Those of marks are eight that
# colour-blind readers can tell apart; a test holds that.
PALETTE: dict[str, tuple[str, str]] = {
    "paper": ("#ffffff", "#14181d"),
    "text": ("#1b1f24", "#e6e9ec"),
    "soft": ("#57606a", "#a3adb8"),
    "line": ("#d0d7de", "#3a434d"),
    "head": ("#f3f5f7", "#1f252c"),
    "c0": ("#0072b2", "#52baff"),
    "c1": ("#d55e00", "#ff8a4a"),
    "c2": ("#009e73", "#29e8ae"),
    "c3": ("#cc79a7", "#be7cc3"),
    "c4": ("#4b1d6b", "#7470de"),
    "c5": ("#e69f00", "#f5e07a"),
    "c6": ("#56b4e9", "#9fd5ff"),
    "c7": ("#444c56", "#c3ccd6"),
}
PAPER, TEXT, SOFT, LINE = (PALETTE[name][0] for name in ("paper", "text", "soft", "line"))
COLOURS = tuple(light for name, (light, _) in PALETTE.items() if name.startswith("c"))
_STYLE: dict[str, Any] = {
    "svg.hashsalt": "carom",
    "svg.fonttype": "none",  # text stays text: it can be searched and read aloud
    "font.family": "DejaVu Sans",
    "font.size": 11,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "figure.facecolor": PAPER,
    "axes.facecolor": PAPER,
    "savefig.facecolor": PAPER,
    "text.color": TEXT,
    "axes.labelcolor": TEXT,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "xtick.labelcolor": TEXT,
    "ytick.labelcolor": TEXT,
    "axes.edgecolor": SOFT,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": LINE,
    "grid.linewidth": 0.7,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "legend.fontsize": 10.5,
}
_SVG = "{http://www.w3.org/2000/svg}"
_HREF = "{http://www.w3.org/1999/xlink}href"
# Verdana is as wide where a reader has no DejaVu.
_FONT = ("'DejaVu Sans'", "'DejaVu Sans', Verdana, sans-serif")


@dataclass(frozen=True)
class Note:
    """What one mark of a figure says when it is pointed at, and the JSON pointer of its data."""

    text: str
    at: str


def variables() -> str:
    """The colours as CSS, for a page and for an SVG file alike."""
    light, dark = (
        "; ".join(f"--{name}: {pair[n]}" for name, pair in PALETTE.items()) for n in range(2)
    )
    return f":root {{ {light} }}\n@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n"


@contextmanager
def figure(
    columns: int = 1, width: float = 8.0, height: float = 5.2, **options: Any
) -> Iterator[tuple[Any, Any]]:
    """A figure and its axes, in the style of all. `options`: of its columns."""
    import matplotlib

    style: dict[Any, Any] = {**matplotlib.rcParamsDefault, "backend": "svg", **_STYLE}
    with matplotlib.rc_context(rc=style):
        from matplotlib.figure import Figure

        made = Figure(figsize=(width, height), layout="constrained")
        yield made, made.subplots(1, columns, **options)


def svg_of(made: Any, title: str) -> str:
    """A figure as an SVG file."""
    root = _tree(made, title)
    style = ElementTree.Element(f"{_SVG}style")
    style.text = variables()
    root.insert(0, style)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{_text(root)}\n'


def inline_svg(made: Any, title: str, notes: Mapping[str, Sequence[Note]]) -> str:
    """A figure as an element of a page, as wide as the page lets it be.

    `notes`: of the marks of each artist, by the artist's id, in the order of its marks.
    """
    root = _tree(made, title)
    for size in ("width", "height"):
        del root.attrib[size]
    for element in list(root.iter(f"{_SVG}g")):
        if element.get("class") in notes:
            _annotate(element, notes[element.attrib["class"]])
    return _text(root)


def _tree(made: Any, title: str) -> ElementTree.Element:
    """The drawing without metadata, clipping and ids that nothing refers to."""
    out = io.StringIO()
    made.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    root = ElementTree.fromstring(out.getvalue())  # noqa: S314 - our own
    root.attrib |= {"role": "img", "aria-label": title}
    root.remove(root[0])  # the metadata
    for parent in root.iter():
        parent.text = parent.text and (parent.text.strip() or None)
        parent.tail = "\n" if parent.tag == f"{_SVG}g" else None
        parent.attrib.pop("clip-path", None)
        if href := parent.attrib.pop(_HREF, ""):
            parent.set("href", href)
        for clip in parent.findall(f"{_SVG}clipPath"):
            parent.remove(clip)
    used = {element.get("href", "")[1:] for element in root.iter()}
    for element in root.iter():
        if (name := element.get("id")) and name not in used:
            del element.attrib["id"]
            element.set("class", re.sub(r"^matplotlib\.|_\d+$", "", name))
    return root


def _annotate(artist: ElementTree.Element, notes: Sequence[Note]) -> None:
    """Mark by mark: a class, the pointer, and a title. The style goes to the group of all."""
    marks = list(artist.iter(f"{_SVG}use")) or [
        path for path in artist.iter(f"{_SVG}path") if path.get("id") is None
    ]
    for mark, note in zip(marks, notes, strict=True):
        artist.set("style", mark.attrib.pop("style"))
        mark.attrib |= {"class": "mark", "data-mark": note.at}
        ElementTree.SubElement(mark, f"{_SVG}title").text = note.text
    for path in artist.iter(f"{_SVG}path"):
        if path.get("id"):
            path.attrib.pop("style", None)


def _text(root: ElementTree.Element) -> str:
    """The tree as text, with short numbers and with variables in the place of colours."""
    for element in root.iter():
        for key in {"x", "y", "d", "transform"} & set(element.attrib):
            element.set(key, re.sub(r"(\.\d\d)\d+", r"\1", element.attrib[key]))
        if "style" in element.attrib:
            style = element.attrib["style"].replace(*_FONT)
            for name, (light, _) in PALETTE.items():
                style = style.replace(light, f"var(--{name}, {light})")
            element.set("style", style)
    ElementTree.register_namespace("", _SVG[1:-1])
    return ElementTree.tostring(root, encoding="unicode")
