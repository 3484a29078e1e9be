"""From a variant to the text of its kernel and its header."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from pathlib import Path

import sympy as sp
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from generator.emission import isa
from generator.emission.banner import banner, source_hash
from generator.emission.exact_context import ExactContext, exact_context
from generator.emission.formatting import format_source
from generator.lowering.counts import OperationCounts
from generator.lowering.fixed_step_loops import Loop, LoopBuilder
from generator.lowering.printer import number
from generator.scenes.models import find_model
from generator.scenes.scene import LIMITS, UNITS, Scene, find_scene
from generator.targets.target import Target, find_target
from generator.variants.names import source_name_of
from generator.variants.rules import require_legal
from generator.variants.variant import Stepper, Variant, make_variant

MEANINGS = {
    "R": "m, radius of both balls",
    "M": "kg, mass of both balls",
    "u_s1": "1, sliding friction of ball 1 and the table",
    "u_s2": "1, sliding friction of ball 2 and the table",
    "u_b": "1, friction between the balls",
    "e_b": "1, restitution between the balls",
}


@dataclass(frozen=True)
class Field:
    """One parameter as the templates show it."""

    name: str
    text: str
    value: str = ""
    check: str = ""


@dataclass(frozen=True)
class KernelSource:
    """The files of one kernel, by name, and what is known of it."""

    variant: Variant
    source_name: str
    header: str
    source: str
    probe: str
    counts: OperationCounts  # of one iteration (fixed step)


@dataclass
class KernelContext:
    """All that templates/kernel.cpp.j2 may see: typed, strict, decided."""

    banner: str
    name: str
    header: str
    prefix: str
    upper: str
    target: Target
    scene: Scene
    variant: Variant
    contract: tuple[str, ...]
    includes: tuple[str, ...]
    pragmas_begin: str
    pragmas_end: str
    fixed: tuple[Field, ...]
    free: tuple[Field, ...]
    fields: tuple[Field, ...]
    tilt_allowed: bool
    vector_frame: bool
    fixed_step: bool
    core_template: str
    project_template: str
    restore_template: str
    steps: int = 0
    helpers: tuple[str, ...] = ()
    functions: tuple[Loop, ...] = ()
    chosen: bool = False
    lift: bool = False
    c_z_before: tuple[str, ...] = ()
    estimate: isa.Estimate | None = None
    pair_rsqrt: tuple[str, ...] = ()
    pair_fma: str = ""
    rsqrt_call: str = "exact_rsqrt"
    exact: ExactContext | None = None
    quad_lanes: tuple[dict[str, str], ...] = field(
        default=tuple({"name": n, "index": str(i)} for i, n in enumerate(("v1", "o1", "v2", "o2")))
    )

    @property
    def u_b_free(self) -> bool:
        return any(f.name == "u_b" for f in self.fields)

    @property
    def u_b_fixed(self) -> str:
        return "Parameters::u_b"

    @property
    def places_fma(self) -> bool:
        return self.variant["fma"] == "fma"

    @property
    def scalar_estimate(self) -> bool:
        """Is a scalar root estimated? Lanes that are slips make all of theirs in pairs."""
        return self.variant.get("simd") != "slips"

    def fma(self, a: str, b: str, c: str) -> str:
        """a * b + c as this kernel rounds it."""
        return f"std::fma({a}, {b}, {c})" if self.places_fma else f"{a} * {b} + {c}"

    def sum_of_squares(self, a: str, b: str) -> str:
        return self.fma(a, a, f"{b} * {b}")

    def pair_sum_of_squares(self, a: str, b: str) -> str:
        if self.pair_fma:
            return f"fma_pair({a}, {a}, {b} * {b})"
        return f"{a} * {a} + {b} * {b}"

    def tilt_term(self, value: str) -> str:
        return f" + {value} * b.f_z" if self.tilt_allowed else ""


def templates_folder() -> Path:
    """Where the templates lie: beside the package in a checkout, inside it when installed."""
    package = Path(str(resources.files("generator")))
    beside = package.parent / "templates"
    return beside if beside.is_dir() else package / "templates"


@cache
def _environment() -> Environment:
    return Environment(
        loader=FileSystemLoader(str(templates_folder())),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
        extensions=[],
    )


def _fields(scene: Scene) -> tuple[tuple[Field, ...], tuple[Field, ...], tuple[Field, ...]]:
    fixed = tuple(
        Field(key, MEANINGS[key], number(sp.Float(scene.fixed[key], 17)))
        for key in UNITS
        if key in scene.fixed
    )
    free = []
    for key in UNITS:
        if key in scene.fixed:
            continue
        low, high = scene.range_of(key)
        check = f"in_range(p.{key}, {low!r}, {high!r})"
        free.append(Field(key, MEANINGS[key], check=check))
    fields = tuple(f for f in free if f.name in scene.free)
    return fixed, tuple(free), fields


def command_for(variant: Variant) -> str:
    return f"./gen --target {variant.target} --scene {variant.scene} --model {variant.model}"


def _contract(variant: Variant, scene: Scene, method: tuple[str, ...]) -> tuple[str, ...]:
    model = find_model(variant.model)
    parameters = ", ".join(
        f"{key} {LIMITS[key][0] if key not in scene.ranges else scene.ranges[key][0]:g} to "
        f"{scene.range_of(key)[1]:g}"
        for key in UNITS
        if key not in scene.fixed
    )
    lines = (
        f"Frictional collision of two equal balls, contact model `{model.name}`: {model.text}.",
        method[0],
        f"Valid: {parameters or 'every parameter is fixed'}; speeds below 1e100 m/s.",
        "Units: m, kg, s, rad. Balls: 9 doubles, row-major position, velocity, angular velocity.",
        *method[1:],
        "Source: Mathavan, Jackson, Parkin, Sports Engineering 17 (2014), Eqs. 3-14.",
    )
    return tuple(part for line in lines for part in textwrap.wrap(line, 96))


def _fixed_step_contract(variant: Variant, counts: OperationCounts) -> tuple[str, ...]:
    return (
        f"Stepper: Euler, N = {variant.stepper.steps} steps; error against the vanishing step "
        "about 1/N of the relative speed, up to 1e-3 of it in hard cases at N = 1000.",
        f"Operations an iteration: {counts.describe()} ({counts.flops} flops).",
    )


def _exact_contract(context: KernelContext) -> tuple[str, ...]:
    exact = context.exact
    assert exact is not None
    return (
        f"Stepper: adaptive {exact.tableau.name}, order {exact.tableau.order}; error against the "
        f"exact solution at most {exact.budget:g} of the relative speed |v1 - v2|, each of v and "
        "R w, as far as verification has seen (docs/accuracy.md).",
        f"Operations a step: {exact.counts.describe()} ({exact.counts.flops} flops), without the "
        "control of its length and the roots' own.",
    )


def _helpers(variant: Variant) -> tuple[str, ...]:
    wanted = []
    rsqrt, simd = variant["rsqrt"], variant["simd"]
    chosen = variant["branch"] == "chosen"
    if rsqrt != "div" or chosen:
        wanted.append("exact_rsqrt")
    if rsqrt in ("est1", "est2"):
        wanted.append("estimate")
    if rsqrt in ("prev", "ahead"):
        wanted.append("refined")
    if variant["branch"] == "bitmask":
        wanted.append("masked")
    if simd in ("balls", "slips"):
        wanted.append("pair")
    if chosen:
        wanted.append("progress")
    return tuple(f"fixed_step/helpers/{name}.j2" for name in wanted)


def _exact(context: KernelContext, variant: Variant, target: Target) -> OperationCounts:
    """Fill in what the exact core needs; the operations of a step."""
    terms = find_model(variant.model).terms
    fixed = LoopBuilder(_plain_loops(variant), terms)
    before = tuple(fixed.low.slips_of_contact())
    after = (*fixed.low.velocities_from_sums(0), *fixed.low.lift_from_sums())
    context.exact = exact_context(variant, terms, target, before, after)
    context.core_template = "exact/single.j2"
    context.lift = terms.lift
    return context.exact.counts


def _plain_loops(variant: Variant) -> Variant:
    """The fixed-step variant whose lowering prints slips and velocities outside any loop."""
    return make_variant(
        variant.target,
        variant.scene,
        variant.model,
        Stepper("euler", steps=1),
        reuse="precompute",
        fma=variant["fma"],
    )


def _fixed_step(context: KernelContext, variant: Variant, target: Target) -> OperationCounts:
    """Fill in what the fixed-step core needs; the operations of an iteration."""
    terms = find_model(variant.model).terms
    builder = LoopBuilder(variant, terms)
    context.functions = tuple(builder.loops())
    context.steps = variant.stepper.steps or 0
    context.helpers = _helpers(variant)
    context.chosen = variant["branch"] == "chosen"
    context.lift = terms.lift
    context.c_z_before = tuple(builder.low.slips_of_contact(only=("c_z",)))
    method = variant["rsqrt"]
    if method.startswith("est"):
        context.estimate = isa.estimate(target, int(method[-1]))
        context.rsqrt_call = f"rsqrt_newton{method[-1]}"
    if variant["simd"] in ("balls", "slips"):
        context.pair_rsqrt = isa.pair_root(target, method)
        context.pair_fma = isa.pair_fma(target) if variant["fma"] == "fma" else ""
    return next((f for f in context.functions if f.pressed), context.functions[0]).counts()


def emit(variant: Variant, prefix: str = "carom", command: str | None = None) -> KernelSource:
    """The text of a kernel, its header and its probe. ValueError where the variant is illegal."""
    target, scene = find_target(variant.target), find_scene(variant.scene)
    require_legal(variant, target)
    fixed, free, fields = _fields(scene)
    begin, end = isa.pragmas(target, contract=variant["fma"] == "autofma")
    vector_frame = variant.get("simd") == "prepost"
    name = source_name_of(variant)
    context = KernelContext(
        banner="",
        name=name,
        header=f"{prefix}.h",
        prefix=prefix,
        upper=prefix.upper(),
        target=target,
        scene=scene,
        variant=variant,
        contract=(),
        includes=("limits", isa.intrinsics_header(target)),
        pragmas_begin=begin,
        pragmas_end=end,
        fixed=fixed,
        free=free,
        fields=fields,
        tilt_allowed=variant.model == "pooltool",
        vector_frame=vector_frame,
        fixed_step=variant.stepper.family == "euler",
        core_template="fixed_step/core.j2",
        project_template=f"sections/project_{'vector' if vector_frame else 'scalar'}.j2",
        restore_template=f"sections/restore_{'vector' if vector_frame else 'scalar'}.j2",
    )
    fixed_step = variant.stepper.family == "euler"
    if fixed_step:
        counts = _fixed_step(context, variant, target)
        method = _fixed_step_contract(variant, counts)
    else:
        counts = _exact(context, variant, target)
        method = _exact_contract(context)
    context.contract = _contract(variant, scene, method)
    command = command or command_for(variant)
    template = _environment().get_template("kernel.cpp.j2")
    body = template.render(k=context, x=context.exact)
    context.banner = banner("kernel.cpp.j2", name, command, source_hash(name, command, body))
    source = template.render(k=context, x=context.exact)
    return KernelSource(
        variant=variant,
        source_name=name,
        header=emit_header(scene, prefix, fields, command),
        source=format_source(source, f"{name}.cpp"),
        probe=emit_probe(prefix, fields, fixed_step),
        counts=counts,
    )


def emit_header(scene: Scene, prefix: str, fields: tuple[Field, ...], command: str) -> str:
    """carom.h for one scene: the same for all its kernels, fixed steps or not."""
    fixed_lines = [f"Fixed: {key} = {scene.fixed[key]!r} {UNITS[key]}" for key in scene.fixed]
    values = {
        "scene": scene,
        "prefix": prefix,
        "upper": prefix.upper(),
        "guard": f"{prefix.upper()}_H_",
        "fields": fields,
        "fixed_lines": fixed_lines,
    }
    template = _environment().get_template("carom.h.j2")
    body = template.render(banner="", **values)
    top = banner("carom.h.j2", f"scene {scene.name}", command, source_hash(body), comment="/*")
    return format_source(template.render(banner=top, **values), f"{prefix}.h")


def emit_probe(prefix: str, fields: tuple[Field, ...], fixed_step: bool) -> str:
    """The adapter through which bench/ calls any scene's kernel with all six parameters."""
    template = _environment().get_template("probe.cpp.j2")
    order = {key: index for index, key in enumerate(UNITS)}
    indexed = [(f.name, order[f.name]) for f in fields]
    return template.render(prefix=prefix, fields=indexed, fixed_step=fixed_step)
