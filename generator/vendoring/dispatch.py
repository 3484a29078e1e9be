"""The dispatcher: which kernel a CPU gets. What a CPU is called and has comes from `targets`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from ..impacts.impact import Functions
from ..lowering.isa import compiled_features
from ..registry.question import symbol_of
from ..targets.host import KNOWN_CPUS, KnownCpu
from ..targets.target import Target, find_target, targets
from .request import VendorRequest

X86, ARM = "x86_64", "aarch64"
_GUARDS = {X86: "defined(__x86_64__)", ARM: "defined(__aarch64__)"}
# Where cpuid says it: a register of leaf 1 or 7, and the bit.
CPUID_BITS = {
    "sse3": ("one.c", 0),
    "ssse3": ("one.c", 9),
    "fma": ("one.c", 12),
    "sse4.1": ("one.c", 19),
    "sse4.2": ("one.c", 20),
    "popcnt": ("one.c", 23),
    "avx": ("one.c", 28),
    "f16c": ("one.c", 29),
    "bmi": ("seven.b", 3),
    "avx2": ("seven.b", 5),
    "bmi2": ("seven.b", 8),
    "avx512f": ("seven.b", 16),
    "avx512dq": ("seven.b", 17),
    "avx512cd": ("seven.b", 28),
    "avx512bw": ("seven.b", 30),
    "avx512vl": ("seven.b", 31),
}
_NEEDS_256 = frozenset({"avx", "avx2", "fma", "f16c"})  # the system must keep 256-bit registers


@dataclass(frozen=True)
class Feature:
    """An instruction set as the dispatcher tests it."""

    name: str
    constant: str
    condition: str
    register: str


@dataclass(frozen=True)
class Exports:
    """The functions of one kernel, as templates/sections/signatures.j2 asks for them."""

    prefix: str
    symbol: str
    fixed_step: bool
    abi: Functions

    @property
    def varied(self) -> str:
        return self.abi.varied

    @property
    def replaced(self) -> tuple[int, ...]:
        """The arrays of a batch that each that it gives replaces."""
        return tuple(
            self.abi.first_in(result.body) + result.first + column
            for result in self.abi.results
            for column in range(result.changed)
        )


@dataclass(frozen=True)
class Pair:
    """The kernels of one target and impact."""

    single: Exports
    batch: Exports  # the same, or those of a kernel for batches alone

    @property
    def kernels(self) -> tuple[Exports, ...]:
        return (self.single,) if self.single == self.batch else (self.single, self.batch)


@dataclass(frozen=True)
class Unit:
    """The kernels of one target."""

    target: str
    pairs: tuple[Pair, ...]  # one for each impact
    guard: str  # preprocessor condition of its architecture
    needs: str  # an expression of the features' constants


@dataclass(frozen=True)
class Preference:
    """A known CPU and the target it gets."""

    vendor: str
    family: int
    model: int  # -1: any
    has: str
    target: str


@dataclass(frozen=True)
class DispatchContext:
    """What templates/vendor/dispatch.cpp.j2 may see."""

    prefix: str
    upper: str
    fixed_step: bool
    outer: tuple[Exports, ...]  # the functions that users call, of each impact
    units: tuple[Unit, ...]
    features: tuple[Feature, ...]
    known: tuple[Preference, ...]

    @property
    def x86(self) -> bool:
        return any(unit.guard == _GUARDS[X86] for unit in self.units)

    @property
    def arm(self) -> bool:
        return any(unit.guard == _GUARDS[ARM] for unit in self.units)

    @property
    def mixed(self) -> bool:
        return self.x86 and self.arm

    @property
    def leaf_seven(self) -> bool:
        return any(feature.register.startswith("seven") for feature in self.features)

    @property
    def wide(self) -> bool:
        return any(feature.condition.startswith("wide ") for feature in self.features)

    @property
    def widest(self) -> bool:
        return any(feature.condition.startswith("widest ") for feature in self.features)


def unit_of(target: str, batch: bool = False) -> str:
    """A target's name as a part of C names and of files; `batch`: of its kernel for batches."""
    return symbol_of(target) + ("_batch" if batch else "")


def preferred_order(names: Sequence[str]) -> tuple[str, ...]:
    """Most instruction sets first; of equals those for any CPU, then as they were asked for."""
    rows = [find_target(name) for name in names]
    return tuple(t.name for t in sorted(rows, key=lambda t: (-_size(t), not t.generic)))


def guard_of(target: str) -> str:
    """The preprocessor condition under which a target's unit can be compiled."""
    return _GUARDS[find_target(target).row.arch]


def is_mixed(names: Sequence[str]) -> bool:
    """Are there several architectures among the targets?"""
    return len({find_target(name).row.arch for name in names}) > 1


def dispatch_context(
    request: VendorRequest, batches: Mapping[str, frozenset[str]] | None = None
) -> DispatchContext:
    """Everything that the dispatcher's text shows.

    `batches`: of each impact, the targets with a kernel for batches.
    """

    def functions(part: VendorRequest, name: str, batch: bool) -> Exports:
        symbol = f"{request.prefix}_{unit_of(name, batch)}" if name else request.prefix
        return Exports(request.prefix, symbol, request.fixed_step, part.row.functions)

    def pair(part: VendorRequest, name: str) -> Pair:
        apart = name in (batches or {}).get(part.impact, ())
        return Pair(functions(part, name, False), functions(part, name, apart))

    order = preferred_order(request.targets)
    told_apart = {cpu.has for cpu in KNOWN_CPUS}
    used = [f for f in CPUID_BITS if f in told_apart or any(f in _needs(t) for t in order)]
    units = tuple(
        Unit(
            target=name,
            pairs=tuple(pair(part, name) for part in request.parts),
            guard=guard_of(name),
            needs=_mask(feature for feature in used if feature in _needs(name)),
        )
        for name in order
    )
    return DispatchContext(
        prefix=request.prefix,
        upper=request.prefix.upper(),
        fixed_step=request.fixed_step,
        outer=tuple(functions(part, "", False) for part in request.parts),
        units=units,
        features=tuple(_feature(name) for name in used),
        known=tuple(p for cpu in KNOWN_CPUS if (p := _preference(cpu, order)) is not None),
    )


def _size(target: Target) -> int:
    return len(compiled_features(target))


def _needs(name: str) -> frozenset[str]:
    return frozenset(compiled_features(find_target(name)))


def _constant(feature: str) -> str:
    return "k" + feature.replace(".", "_").capitalize()


def _mask(features: Iterable[str]) -> str:
    return " | ".join(_constant(feature) for feature in features) or "0"


def _feature(name: str) -> Feature:
    register, bit = CPUID_BITS[name]
    condition = f"({register} >> {bit} & 1u) != 0"
    if name in _NEEDS_256:
        condition = f"wide && {condition}"
    if name.startswith("avx512"):
        condition = f"widest && {condition}"
    return Feature(name, _constant(name), condition, register)


def _preference(cpu: KnownCpu, order: Sequence[str]) -> Preference | None:
    """What a known CPU gets: its own target; else the most instruction sets, and of equals the
    nearest ancestor. None where none of `order` runs on it.
    """
    own = targets()[cpu.target]
    runs = [n for n in order if _needs(n) <= frozenset(compiled_features(own))]
    runs = [n for n in runs if find_target(n).row.arch == own.row.arch]
    if not runs:
        return None
    line = (own.name, *own.ancestors)

    def rank(name: str) -> tuple[bool, int, int]:
        place = line.index(name) if name in line else len(line)
        return name != own.name, -_size(find_target(name)), place

    model = -1 if cpu.model is None else cpu.model
    return Preference(
        cpu.vendor, cpu.family, model, _mask([cpu.has] * bool(cpu.has)), min(runs, key=rank)
    )
