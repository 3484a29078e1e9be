"""All files of a vendored folder but the manifest, as texts by name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from .. import __version__
from ..emission.banner import Banner, bannered
from ..emission.context import Naming
from ..emission.environment import environment
from ..emission.formatting import format_source
from ..emission.header import HeaderUse, header_of
from ..emission.kernel_source import emit
from ..toolchain.flags import STRICT
from .dispatch import dispatch_context, guard_of, is_mixed, unit_of
from .golden import GoldenRow
from .kernels import Chosen, TargetKernels
from .part import PartContext, part_of
from .request import VendorRequest

_MACRO = re.compile(r"^#define (\w+)", re.MULTILINE)


@dataclass(frozen=True)
class PackageContext:
    """What templates see of the whole folder, the dispatcher's apart."""

    request: VendorRequest
    parts: tuple[PartContext, ...]
    sources: tuple[str, ...]
    dispatched: bool
    header: str = ""  # for the single header: the text of the header
    unit_texts: tuple[str, ...] = ()  # and of what is compiled

    @property
    def prefix(self) -> str:
        return self.request.prefix

    @property
    def upper(self) -> str:
        return self.prefix.upper()

    @property
    def version(self) -> str:
        return __version__

    @property
    def compatibility(self) -> str:
        """Before 1.0 a minor version may change the interface."""
        return "SameMinorVersion" if __version__.startswith("0.") else "SameMajorVersion"

    @property
    def targets(self) -> tuple[str, ...]:
        return self.request.targets

    @property
    def single_header(self) -> bool:
        return self.request.single_header

    @property
    def headers(self) -> tuple[str, ...]:
        return f"{self.prefix}.h", f"{self.prefix}.hpp"

    @property
    def flags(self) -> tuple[str, ...]:
        return STRICT

    @property
    def description(self) -> str:
        return " ".join(part.description for part in self.parts)


def unit_file(part: VendorRequest, target: str, batch: bool = False) -> str:
    return f"{part.prefix}_{_unit_name(part, target, batch)}.cpp"


def _unit_name(part: VendorRequest, target: str, batch: bool) -> str:
    """Of a kernel in file names and namespaces, where those of all impacts are."""
    return f"{part.row.functions.prefix}{unit_of(target, batch)}"


def package_files(
    request: VendorRequest, chosen: Chosen, rows: Mapping[str, tuple[GoldenRow, ...]]
) -> dict[str, str]:
    """Names and texts; the same request, kernels and sources give the same bytes.

    `chosen`: the kernels of each impact and target; `rows`: golden vectors of each impact. Raises
    ValueError or InputError where a kernel cannot be made any more.
    """
    batches = {part.impact: _batches(part, chosen[part.impact]) for part in request.parts}
    dispatched = len(request.targets) > 1 or any(batches.values())
    units = {
        name: text
        for part in request.parts
        for name, text in _units(part, chosen[part.impact], request.command, dispatched).items()
    }
    if dispatched:
        units[f"{request.prefix}_dispatch.cpp"] = _page(
            request, "dispatch.cpp", "//", "a.cpp", d=dispatch_context(request, batches)
        )
    use = HeaderUse(fixed_step=request.fixed_step, dispatched=dispatched)
    scenes = [(part.row, part.known_scene) for part in request.parts]
    header = header_of(scenes, request.prefix, request.command, use)
    parts = tuple(part_of(part, rows[part.impact], dispatched) for part in request.parts)
    context = PackageContext(request, parts, tuple(units), dispatched)
    files = {
        "LICENSE": environment().get_template("vendor/LICENSE.j2").render(),
        "README.md": _page(request, "README.md", "", v=context),
        # Else git may change line ends, and with them the hashes.
        ".gitattributes": "# MIT-0\n* -text\n",
    }
    for part in parts:
        files[part.selftest_file] = _page(request, "selftest.c", "/*", "a.c", v=part)
    if request.single_header:
        files[f"{request.prefix}.h"] = _single(request, context, header, units)
    else:
        files |= units
        files[f"{request.prefix}.h"] = header
        files[f"{request.prefix}.hpp"] = _page(request, "typed.hpp", "//", "a.hpp", v=context)
        files["CMakeLists.txt"] = _page(request, "CMakeLists.txt", "#", v=context)
        files[f"{request.prefix}-config.cmake"] = _page(request, "config.cmake", "#", v=context)
        files[f"{request.prefix}.pc.in"] = _page(request, "pc.in", "#", v=context)
    return dict(sorted(files.items()))


def _batches(part: VendorRequest, chosen: Mapping[str, TargetKernels]) -> frozenset[str]:
    """The targets with a kernel of its own for batches."""
    return frozenset(t for t in part.targets if chosen[t].batch is not None)


def _units(
    part: VendorRequest, chosen: Mapping[str, TargetKernels], command: str, dispatched: bool
) -> dict[str, str]:
    """Names and texts of an impact's kernels: one for each target, and one for its batches."""
    units = {}
    for target in part.targets:
        kernels = {False: chosen[target].single, True: chosen[target].batch}
        for batch, entry in kernels.items():
            if entry is not None:
                naming = Naming(
                    prefix=part.prefix,
                    unit=unit_of(target, batch) if dispatched else "",
                    enclosing=f"{part.prefix}_{_unit_name(part, target, batch)}",
                )
                text = emit(entry.variant, naming, command, entry.grounds).source
                units[unit_file(part, target, batch)] = _guarded(part, target, text)
    return units


def _guarded(request: VendorRequest, target: str, text: str) -> str:
    """Where architectures are mixed, each compiles its own units."""
    if not is_mixed(request.targets):
        return text
    return f"#if {guard_of(target)}  // else this file is empty\n{text}#endif\n"


def _single(
    request: VendorRequest, context: PackageContext, header: str, units: Mapping[str, str]
) -> str:
    """Everything in one header: units follow each other and leave no macro behind."""
    own = f'#include "{request.prefix}.h"\n'
    texts = []
    for text in units.values():
        assert own in text
        macros = dict.fromkeys(_MACRO.findall(text))
        texts.append(text.replace(own, "") + "".join(f"#undef {name}\n" for name in macros))
    whole = replace(context, sources=(), header=header, unit_texts=tuple(texts))
    return _page(request, "single.h", "/*", v=whole)


def _page(
    request: VendorRequest, template: str, comment: str, formatted_as: str = "", **values: object
) -> str:
    """A template filled, with the banner on top; `formatted_as`: a file name for clang-format."""
    made_for = {"package": f"{request.prefix}, scene {request.scene}, model {request.model}"}
    text = bannered(
        f"vendor/{template}.j2",
        values,
        Banner(made_for, request.command, (repr(request),), comment),
    )
    return format_source(text, formatted_as) if formatted_as else text
