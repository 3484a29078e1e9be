"""All files of a vendored folder but the manifest, as texts by name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from .. import __version__
from ..choice.selection import Selected
from ..emission.banner import Banner, bannered
from ..emission.context import Field, Naming
from ..emission.environment import environment
from ..emission.formatting import format_source
from ..emission.header import HeaderUse, emit_header
from ..emission.kernel_source import emit
from ..emission.parameters import fields_of
from ..impacts.impact import Functions, Impact
from ..impacts.scene import BaseScene
from ..registry.question import find_impact
from ..toolchain.flags import STRICT
from .dispatch import dispatch_context, guard_of, is_mixed, unit_of
from .golden import GoldenRow
from .kernels import TargetKernels
from .request import VendorRequest

_OF_IMPACT = ("typed.hpp",)  # templates that each impact has for itself
_MACRO = re.compile(r"^#define (\w+)", re.MULTILINE)


@dataclass(frozen=True)
class PackageContext:
    """What the templates in templates/vendor may see, the dispatcher's apart."""

    request: VendorRequest
    scene: BaseScene
    rows: tuple[GoldenRow, ...]
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
    def fixed_step(self) -> bool:
        return self.request.fixed_step

    @property
    def single_header(self) -> bool:
        return self.request.single_header

    @property
    def headers(self) -> tuple[str, ...]:
        return f"{self.prefix}.h", f"{self.prefix}.hpp"

    @property
    def selftest(self) -> str:
        return selftest_name(self.request)

    @property
    def flags(self) -> tuple[str, ...]:
        return STRICT

    @property
    def fields(self) -> tuple[Field, ...]:
        return fields_of(self.impact, self.scene).given

    @property
    def impact(self) -> Impact:
        return find_impact(self.request.impact)

    @property
    def abi(self) -> Functions:
        return self.impact.functions

    @property
    def symbol(self) -> str:
        return self.prefix

    @property
    def varied(self) -> str:
        return self.abi.varied

    @property
    def speeds(self) -> tuple[int, ...]:
        """Which numbers of the bodies are speeds."""
        before = len(self.impact.columns.parameters)
        return tuple(column - before for column in self.impact.columns.speeds)

    @property
    def varied_text(self) -> str:
        if self.scene.makes_varied:
            return f"`{self.varied}` must be empty: the kernel makes it"
        return f"`{self.varied}` may be empty: then the parameters decide"

    @property
    def goal_text(self) -> str:
        goal = self.request.goal
        if goal.budget is None:
            return f"by {goal.steps} fixed steps"
        return f"exact to {goal.budget:g} of {self.impact.relative_to}"

    @property
    def description(self) -> str:
        model, scene = self.request.model, self.scene.name
        return (
            f"Frictional collision of {self.impact.text}: contact model {model}, scene {scene}, "
            f"{self.goal_text}."
        )

    @property
    def method(self) -> str:
        """How the golden answers were found."""
        if self.fixed_step:
            return (
                f"Answers of the fixed-step scheme with N = {self.request.goal.steps} in long "
                "double, written apart from the kernels; cases that rounding could flip by a step "
                "are left out."
            )
        return (
            "Answers of an exact solver in long double (Taylor series of high order in the full "
            "velocities), written apart from the kernels; good to about 1e-15."
        )


def selftest_name(request: VendorRequest) -> str:
    """In one header the self-test holds the implementation, and so is C++."""
    return f"{request.prefix}_selftest.{'cpp' if request.single_header else 'c'}"


def unit_file(request: VendorRequest, target: str, batch: bool = False) -> str:
    return f"{request.prefix}_{unit_of(target, batch)}.cpp"


def package_files(
    request: VendorRequest, chosen: Mapping[str, TargetKernels], rows: tuple[GoldenRow, ...]
) -> dict[str, str]:
    """Names and texts; the same request, kernels and sources give the same bytes.

    `chosen`: the kernels of each target. Raises ValueError or InputError where a kernel cannot be
    made any more.
    """
    batches = frozenset(t for t in request.targets if chosen[t].batch is not None)
    dispatched = len(request.targets) > 1 or bool(batches)
    units = _units(request, chosen, dispatched)
    if dispatched:
        units[f"{request.prefix}_dispatch.cpp"] = _page(
            request, "dispatch.cpp", "//", "a.cpp", d=dispatch_context(request, batches)
        )
    use = HeaderUse(fixed_step=request.fixed_step, dispatched=dispatched)
    scene = request.known_scene
    header = emit_header(find_impact(request.impact), scene, request.prefix, request.command, use)
    context = PackageContext(request, scene, rows, tuple(units), dispatched)
    files = {
        "LICENSE": environment().get_template("vendor/LICENSE.j2").render(),
        "README.md": _page(request, "README.md", "", v=context),
        context.selftest: _page(request, "selftest.c", "/*", "a.c", v=context),
        # Else git may change line ends, and with them the hashes.
        ".gitattributes": "# MIT-0\n* -text\n",
    }
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


def _units(
    request: VendorRequest, chosen: Mapping[str, TargetKernels], dispatched: bool
) -> dict[str, str]:
    """Names and texts of the kernels: one for each target, and one for its batches."""
    units = {}
    for target in request.targets:
        kernels = {False: chosen[target].single, True: chosen[target].batch}
        for batch, entry in kernels.items():
            if entry is not None:
                unit = unit_of(target, batch)
                text = _unit(request, unit, entry, dispatched)
                units[unit_file(request, target, batch)] = _guarded(request, target, text)
    return units


def _unit(request: VendorRequest, unit: str, entry: Selected, dispatched: bool) -> str:
    """One translation unit: alone, or one of several behind the dispatcher."""
    naming = Naming(
        prefix=request.prefix,
        unit=unit if dispatched else "",
        enclosing=f"{request.prefix}_{unit}",
    )
    return emit(entry.variant, naming, request.command, entry.grounds).source


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
    own = find_impact(request.impact).folder if template in _OF_IMPACT else "vendor"
    page = f"{own}/{template}.j2"
    text = bannered(page, values, Banner(made_for, request.command, (repr(request),), comment))
    return format_source(text, formatted_as) if formatted_as else text
