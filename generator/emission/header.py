"""The header of one scene of an impact, or of a scene each of several impacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..impacts.impact import Functions, Impact
from ..impacts.scene import BaseScene
from .banner import Banner, bannered, impact_modules
from .context import Field
from .formatting import format_source
from .parameters import fields_of


@dataclass(frozen=True)
class HeaderUse:
    """What a header says beyond the scene. `fixed_step` None: it serves both kinds of kernels."""

    fixed_step: bool | None = None
    dispatched: bool = False  # are there several kernels behind it?


@dataclass(frozen=True)
class Section:
    """The struct and the functions of one impact; names as in templates/carom.h.j2."""

    impact: Impact
    scene: BaseScene
    prefix: str

    @property
    def symbol(self) -> str:
        return self.prefix

    @property
    def upper(self) -> str:
        return self.prefix.upper()

    @property
    def abi(self) -> Functions:
        return self.impact.functions

    @property
    def varied(self) -> str:
        return self.abi.varied

    @property
    def varied_note(self) -> str:
        return self.impact.words().varied_note(self.scene)

    @property
    def fields(self) -> tuple[Field, ...]:
        return fields_of(self.impact, self.scene).given

    @property
    def lines(self) -> tuple[str, ...]:
        """What the scene fixes, and what it says of the motions."""
        units = {parameter.name: parameter.unit for parameter in self.impact.parameters}
        fixed = self.scene.fixed.items()
        return (
            *(f"Fixed: {key} = {value!r} {units[key]}" for key, value in fixed),
            *self.impact.words().scene_lines(self.scene),
        )

    @property
    def comments(self) -> str:
        """The template whose macros say what the functions do."""
        return f"{self.impact.folder}/header.j2"


def emit_header(
    impact: Impact,
    scene: BaseScene,
    prefix: str = "carom",
    command: str | None = None,
    use: HeaderUse | None = None,
) -> str:
    """carom.h for one scene: the same for all its kernels, fixed steps or not."""
    return header_of([(impact, scene)], prefix, command, use)


def header_of(
    parts: Sequence[tuple[Impact, BaseScene]],
    prefix: str = "carom",
    command: str | None = None,
    use: HeaderUse | None = None,
) -> str:
    """One header for a scene each of several impacts; a status has one value in all of them."""
    use = use or HeaderUse()
    sections = [Section(impact, scene, prefix) for impact, scene in parts]
    statuses = {status.name: status for section in sections for status in section.impact.statuses}
    ordered = sorted(statuses.values(), key=lambda status: status.value)
    values = {
        "sections": sections,
        "statuses": ordered,
        "prefix": prefix,
        "upper": prefix.upper(),
        "guard": f"{prefix.upper()}_H_",
        "use": use,
    }
    named = ", ".join(_named(impact, scene) for impact, scene in parts)
    remake = command or f"./gen emit --header {named}"
    scenes = (scene.model_dump_json() for _, scene in parts)
    modules = (text for impact, _ in parts for text in impact_modules(impact.folder))
    data = (*scenes, prefix, repr(use), *modules)
    text = bannered("carom.h.j2", values, Banner({"scene": named}, remake, data, "/*"))
    return format_source(text, f"{prefix}.h")


def _named(impact: Impact, scene: BaseScene) -> str:
    """A scene as `--header` takes it: of the default impact by its name alone."""
    return scene.name if not impact.functions.prefix else f"{impact.name}/{scene.name}"
