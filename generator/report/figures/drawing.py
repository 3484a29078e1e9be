"""How all figures look: the same bytes for the same data, and readable on light and dark pages."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

# Okabe and Ito's colours, which colour-blind readers can tell apart.
BLACK, ORANGE, SKY, GREEN, BLUE, RED, PINK, GREY = (
    "#000000",
    "#e69f00",
    "#56b4e9",
    "#009e73",
    "#0072b2",
    "#d55e00",
    "#cc79a7",
    "#767676",
)
_STYLE: dict[str, Any] = {
    "svg.hashsalt": "carom",
    "svg.fonttype": "path",  # a reader's fonts would move the text
    "figure.facecolor": "white",
    "axes.facecolor": "white",
    "savefig.facecolor": "white",
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "axes.edgecolor": "#444444",
    "axes.spines.top": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "legend.frameon": False,
}


@contextmanager
def figure(columns: int = 1, width: float = 8.0, height: float = 5.2) -> Iterator[tuple[Any, Any]]:
    """A figure and its axes, in the style of all."""
    import matplotlib

    style: dict[Any, Any] = {**matplotlib.rcParamsDefault, "backend": "svg", **_STYLE}
    with matplotlib.rc_context(rc=style):
        from matplotlib.figure import Figure

        made = Figure(figsize=(width, height), layout="constrained")
        yield made, made.subplots(1, columns)


def svg_of(made: Any, title: str) -> str:
    """A figure as SVG that holds no date and no version."""
    out = io.StringIO()
    made.savefig(out, format="svg", metadata={"Date": None, "Creator": None, "Title": title})
    lines = out.getvalue().splitlines()
    return "\n".join(line.rstrip() for line in lines) + "\n"
