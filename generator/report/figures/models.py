"""How far the models of an impact differ, as the impact itself shows it."""

from __future__ import annotations

from dataclasses import dataclass

from ...evidence.timing.bench_tool import BenchTool


@dataclass(frozen=True)
class Drawn:
    """A picture as SVG, and what it shows in words."""

    svg: str
    lines: tuple[str, ...]


def models_picture(tool: BenchTool) -> Drawn:
    """The picture that the tool's impact has in its module `picture`: `picture(tool)`."""
    drawn: Drawn = tool.impact.part("picture").picture(tool)
    return drawn
