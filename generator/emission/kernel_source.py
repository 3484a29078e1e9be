"""From a variant to the text of its kernel and its header."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, field

import sympy as sp

from ..errors import InputError
from ..impacts.ball_ball import words
from ..impacts.ball_ball.masses import masses_of
from ..impacts.ball_ball.models import find_model
from ..impacts.ball_ball.parameters import UNITS, case_value
from ..impacts.ball_ball.scene import Scene, find_scene
from ..lowering import isa
from ..lowering.collision_ends import CollisionEnds, at_zero
from ..lowering.counts import OperationCounts
from ..lowering.lanes import LaneContext, lane_context
from ..lowering.printer import number
from ..lowering.text_counts import operations_in
from ..registry.lane_numbers import precision_of
from ..registry.names import source_name_of, source_recipe_of
from ..registry.rules import require_legal
from ..registry.variant import Variant
from ..steppers.exact.context import ExactContext, exact_context
from ..steppers.fixed.batch import FixedStepBatch, fixed_step_batch
from ..steppers.fixed.loops import Loop, LoopBuilder
from ..targets.target import Target, target_or_port
from .banner import bannered
from .environment import environment
from .formatting import format_source
from .marks import without_marks


@dataclass(frozen=True)
class Field:
    """One parameter as the templates show it."""

    name: str
    text: str
    value: str = ""
    check: str = ""


@dataclass(frozen=True)
class Naming:
    """What a kernel's types and functions are called; two kernels in one program differ in it."""

    prefix: str = "carom"  # of types, statuses and the header
    unit: str = ""  # one of several kernels behind a dispatcher: part of its functions' names
    enclosing: str = ""  # a namespace around everything, or empty: then only an unnamed one

    @property
    def symbol(self) -> str:
        """What the names of the functions begin with."""
        return f"{self.prefix}_{self.unit}" if self.unit else self.prefix


@dataclass(frozen=True)
class HeaderUse:
    """What a header says beyond the scene. `fixed_step` None: it serves both kinds of kernels."""

    fixed_step: bool | None = None
    dispatched: bool = False  # are there several kernels behind it?


_PLAIN, _ANY_USE = Naming(), HeaderUse()
_COUNTED = {"fixed": "an iteration", "exact": "a step"}  # what a banner counts operations of


@dataclass(frozen=True)
class KernelSource:
    """The files of one kernel, by name, and what is known of it."""

    variant: Variant
    source_name: str
    header: str
    source: str
    probe: str
    counts: OperationCounts  # of one iteration (fixed step), one step, or the closed form
    text_counts: OperationCounts  # of all that stands in the source
    marked: str = ""  # as `source`, not formatted, with the marks of emission/marks.py


@dataclass
class KernelContext:
    """All that templates/kernel.cpp.j2 may see: typed, strict, decided."""

    name: str
    header: str
    prefix: str  # of the types and statuses in the header
    symbol: str  # of the functions: the prefix, and where there are several units the unit
    enclosing: str  # the namespace around everything, or empty
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
    lanes: LaneContext | None = None  # the vocabulary of batches in lanes
    euler_batch: FixedStepBatch | None = None
    u_b_range: tuple[str, str] = ("0.0", "0.0")
    closed_counts: OperationCounts = field(default_factory=OperationCounts)
    contact_slip: tuple[str, ...] = ()  # c_x and c_z, where friction depends on them
    lanes_slip: tuple[str, ...] = ()  # the same in lanes
    checks: tuple[str, ...] = ()  # conditions on the parameters
    law: tuple[str, str, str] | None = None  # of friction, where the kernel makes it
    motions: tuple[str, ...] = ()  # velocities that are zero in the scene, as ball1[6]
    level_pairs: tuple[tuple[str, str], ...] = ()  # velocities that are equal in the scene
    quad_lanes: tuple[dict[str, str], ...] = field(
        default=tuple({"name": n, "index": str(i)} for i, n in enumerate(("v1", "o1", "v2", "o2")))
    )

    @property
    def batch(self) -> bool:
        """Are batches of collisions worked on in lanes?"""
        return self.lanes is not None

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

    @property
    def level_ends(self) -> bool:
        """Do the spins' level components stay zero, so that they need not be written?"""
        return self.scene.level and not self.tilt_allowed and not self.fixed_step

    def projects(self, name: str) -> bool:
        """Is a velocity of the contact read from the input, or known to be zero?"""
        zero = {symbol.name for symbol in at_zero(self.scene)}
        return self.vector_frame or self.tilt_allowed or name not in zero

    @property
    def spinning(self) -> tuple[int, ...]:
        """The balls that may spin before."""
        return tuple(ball for ball in (1, 2) if f"o{ball}z" in self.live)

    @property
    def live(self) -> tuple[str, ...]:
        """The velocities that are not known to be zero before."""
        names = (f"{kind}{ball}{axis}" for ball in "12" for kind in "vo" for axis in "xyz")
        return tuple(name for name in names if self.projects(name))

    def tilt_term(self, value: str) -> str:
        return f" + {value} * b.f_z" if self.tilt_allowed else ""


def _fields(scene: Scene) -> tuple[tuple[Field, ...], tuple[Field, ...], tuple[Field, ...]]:
    """Constants, members of Parameters, and those of them that the caller gives."""
    values = scene.constants
    fixed = tuple(
        Field(key, words.meaning(key, scene), number(sp.Float(values[key], 17)))
        for key in scene.members
        if key in values
    )
    free = tuple(
        Field(key, words.meaning(key, scene), check=words.check(key, scene))
        for key in scene.members
        if key not in values
    )
    fields = tuple(f for f in free if f.name in scene.free)
    return fixed, free, fields


def fields_of(scene: Scene) -> tuple[Field, ...]:
    """The members of carom_params, in their order."""
    return _fields(scene)[2]


def _contract(variant: Variant, scene: Scene, method: tuple[str, ...]) -> tuple[str, ...]:
    lines = words.contract(scene, variant.model, method)
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
    if context.scene.level:
        counts = context.closed_counts
        return (
            "Closed form, exact but for rounding: no ball is pressed onto the table.",
            f"Operations: {counts.describe()} ({counts.flops} flops).",
        )
    table = "" if context.scene.table_friction else " of the contact slip alone"
    return (
        f"Stepper: adaptive {exact.tableau.name}, order {exact.tableau.order}{table}; error "
        f"against the exact solution at most {exact.budget:g} of the relative speed |v1 - v2|, "
        "each of v and R w, as far as verification has seen (docs/accuracy.md).",
        *_batch_lines(context),
        f"Operations a step: {exact.counts.describe()} ({exact.counts.flops} flops), without the "
        "control of its length and the roots' own.",
    )


def _batch_lines(context: KernelContext) -> tuple[str, ...]:
    """What batches do otherwise than single calls, for the contract."""
    if context.lanes is None or not context.lanes.floats or context.scene.precision == "float":
        return ()
    return (
        "Batches: the steps in floats, whose rounding that bound includes; all that is before and "
        "after them in doubles.",
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
    """Fill in what the exact core needs; the operations of a step, or of the closed form."""
    terms, scene = find_model(variant.model).terms, context.scene
    scene.require_budget(variant.stepper.budget or 0.0)
    context.exact = exact_context(variant, scene, terms, target)
    if variant.width > 1:
        context.lanes = _lanes(variant, target)
    context.lift = terms.lift
    context.core_template = "exact/single.j2"
    if not scene.table_friction:
        context.core_template = "exact/free.j2"
    if scene.level:
        context.core_template = "exact/level_only.j2"
        # The closed form's own: the normal impulse, the least of two, its sign.
        own = OperationCounts(add=1, mul=4, compare=1, select=1)
        context.closed_counts = context.exact.level.after.counts + own
        return context.closed_counts
    return context.exact.counts


def _lanes(variant: Variant, target: Target) -> LaneContext:
    """The vocabulary of a variant's batches. InputError where its scene has none."""
    scene = find_scene(variant.scene)
    exact = variant.stepper.family == "exact"
    if exact and (reason := scene.without_exact_lanes):
        raise InputError(f"--scene {scene.name}: {reason}; expected width 1")
    fma = variant["fma"] == "fma"
    estimates = variant["lane_root"] != "ieee"
    return lane_context(
        target, variant.width, variant.vectors, fma, precision_of(variant), estimates
    )


def _fixed_step(context: KernelContext, variant: Variant, target: Target) -> OperationCounts:
    """Fill in what the fixed-step core needs; the operations of an iteration."""
    scene = context.scene
    if not scene.fixed_steps:
        raise InputError(f"--scene {scene.name}: {words.NO_FIXED_STEPS}")
    terms = find_model(variant.model).terms
    builder = LoopBuilder(variant, terms)
    context.functions = tuple(builder.loops(scene.level))
    context.steps = variant.stepper.steps or 0
    only_level = scene.level and variant["branch"] == "chosen"  # no root is taken there
    context.helpers = () if only_level else _helpers(variant)
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
    if variant.width > 1:
        context.lanes = _lanes(variant, target)
        context.euler_batch = fixed_step_batch(variant, terms, context.lanes)
    return next((f for f in context.functions if f.pressed), context.functions[0]).counts()


def emit(
    variant: Variant, naming: Naming = _PLAIN, command: str | None = None, grounds: str = ""
) -> KernelSource:
    """The text of a kernel, its header and its probe. ValueError where the variant is illegal.

    `grounds`: what its choice rests on, for the banner.
    """
    target, scene = target_or_port(variant.target), find_scene(variant.scene)
    require_legal(variant, target)
    fixed, free, fields = _fields(scene)
    begin, end = isa.pragmas(target, contract=variant["fma"] == "autofma")
    vector_frame = variant.get("simd") == "prepost"
    terms = find_model(variant.model).terms
    masses = masses_of(scene.mass_ratio)
    motions, level_pairs = words.motions(scene)
    name = source_name_of(variant)
    context = KernelContext(
        name=name,
        header=f"{naming.prefix}.h",
        prefix=naming.prefix,
        symbol=naming.symbol,
        enclosing=naming.enclosing,
        upper=naming.prefix.upper(),
        target=target,
        scene=scene,
        variant=variant,
        contract=(),
        includes=("limits", *isa.intrinsics_headers(target)),
        pragmas_begin=begin,
        pragmas_end=end,
        fixed=fixed,
        free=free,
        fields=fields,
        tilt_allowed=variant.model == "pooltool",
        vector_frame=vector_frame,
        fixed_step=variant.stepper.family == "fixed",
        core_template="fixed_step/core.j2",
        project_template=f"sections/project_{'vector' if vector_frame else 'scalar'}.j2",
        restore_template=f"sections/restore_{'vector' if vector_frame else 'scalar'}.j2",
    )
    context.motions = motions
    context.level_pairs = level_pairs if scene.level and terms.lift else ()
    low, high = scene.range_of("u_b")
    context.u_b_range = (repr(low), repr(high))
    context.checks = (*(f.check for f in fields), *words.joint_checks(scene))
    context.law = words.law(scene)
    if context.law:
        one, lanes = (
            CollisionEnds(terms, masses, at_zero(scene), variant["fma"] == "fma", wide)
            for wide in (False, True)
        )
        context.contact_slip = one.slips(("c_x", "c_z")).lines
        context.lanes_slip = lanes.slips(("c_x", "c_z")).lines
    fixed_step = variant.stepper.family == "fixed"
    if fixed_step:
        counts = _fixed_step(context, variant, target)
        method = _fixed_step_contract(variant, counts)
    else:
        counts = _exact(context, variant, target)
        method = _exact_contract(context)
    context.contract = _contract(variant, scene, method)
    shown = {"k": context, "x": context.exact, "lanes": context.lanes, "b": context.euler_batch}
    data = (name, repr(naming), *_data_of(target), scene.model_dump_json())
    remake = command or f"./gen emit {name}"
    rows = {
        "question": str(variant.question),
        "recipe": source_recipe_of(variant),
        "counts": f"{counts.describe()} {_COUNTED[variant.stepper.family]}",
    }
    text = bannered("kernel.cpp.j2", rows, remake, data, shown, grounds=grounds)
    if line := isa.estimates_line(text):
        context.contract += tuple(textwrap.wrap(line, 96))
        text = bannered("kernel.cpp.j2", rows, remake, data, shown, grounds=grounds)
    source = format_source(without_marks(text), variant.question.file)
    return KernelSource(
        variant=variant,
        source_name=name,
        header=emit_header(scene, naming.prefix, command),
        source=source,
        probe=emit_probe(naming.prefix, fields, fixed_step, law=bool(context.law)),
        counts=counts,
        text_counts=operations_in(source),
        marked=text,
    )


def _data_of(target: Target) -> tuple[str, ...]:
    return target.row.model_dump_json(), *sorted(target.features)


def emit_header(
    scene: Scene, prefix: str = "carom", command: str | None = None, use: HeaderUse = _ANY_USE
) -> str:
    """carom.h for one scene: the same for all its kernels, fixed steps or not."""
    fields = fields_of(scene)
    fixed_lines = [f"Fixed: {key} = {scene.fixed[key]!r} {UNITS[key]}" for key in scene.fixed]
    fixed_lines += words.scene_lines(scene)
    values = {
        "scene": scene,
        "prefix": prefix,
        "upper": prefix.upper(),
        "guard": f"{prefix.upper()}_H_",
        "fields": fields,
        "fixed_lines": fixed_lines,
        "use": use,
        "u_b_text": words.varied_note(scene),
    }
    remake = command or f"./gen emit --header {scene.name}"
    data = (scene.model_dump_json(), prefix, repr(use))
    text = bannered("carom.h.j2", {"scene": scene.name}, remake, data, values, "/*")
    return format_source(text, f"{prefix}.h")


def emit_probe(prefix: str, fields: tuple[Field, ...], fixed_step: bool, law: bool = False) -> str:
    """The adapter through which bench/ calls any scene's kernel with all six parameters."""
    template = environment().get_template("probe.cpp.j2")
    values = [(f.name, case_value(f.name, "given")) for f in fields]
    return template.render(prefix=prefix, fields=values, fixed_step=fixed_step, law=law)
