"""What there is to choose from: impacts, targets, scenes, contact models, options of kernels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass

from ..impacts import registry as all_impacts
from ..registry.axes import AXES
from ..registry.lanes import INSTRUCTION_SETS
from ..registry.rules import RULES
from ..targets.host import Host, read_host
from ..targets.target import Target
from ..targets.target import targets as all_targets
from ..toolchain.compilers import compilers_for, emulator_for


@dataclass(frozen=True)
class ImpactRow:
    """What collides: the parameters of a call in their order, and the contact models."""

    name: str
    what: str
    parameters: tuple[str, ...]
    models: tuple[str, ...]


@dataclass(frozen=True)
class TargetRow:
    """A CPU: `tested_here` says how its kernels can be tested on this machine."""

    name: str
    what: str
    vector_bits: int
    registers: int
    llvm_mca: str
    tested_here: str


@dataclass(frozen=True)
class SceneRow:
    """What is known of a shot; `fixed`: parameters in SI units; `max_error`: its usual budget."""

    name: str
    what: str
    fixed: Mapping[str, float]
    model: str
    max_error: float


@dataclass(frozen=True)
class ModelRow:
    """A contact model and the terms in which the models of its impact differ."""

    name: str
    terms: Mapping[str, object]
    what: str


@dataclass(frozen=True)
class ChoiceRow:
    """One choice of an option axis; the first of an axis is the default."""

    axis: str
    choice: str
    what: str


@dataclass(frozen=True)
class LanesRow:
    """Lanes of an instruction set's vectors, by the numbers in them."""

    set: str
    double: int
    float: int
    what: str


@dataclass(frozen=True)
class RuleRow:
    """A combination of options that is refused."""

    rule: str
    reason: str


@dataclass(frozen=True)
class PresetRow:
    """Options under one name; what is not named is the default."""

    name: str
    what: str
    options: Mapping[str, str]


@dataclass(frozen=True)
class Variants:
    """The registry of kernels: option axes, lanes, rules and presets."""

    axes: tuple[ChoiceRow, ...]
    lanes: tuple[LanesRow, ...]
    rules: tuple[RuleRow, ...]
    presets: tuple[PresetRow, ...]


def targets() -> tuple[TargetRow, ...]:
    """The CPUs that kernels can be made for."""
    host = read_host()
    return tuple(_target(target, host) for target in all_targets().values())


def _target(target: Target, host: Host) -> TargetRow:
    row, tested = target.row, how_tested(target, host.target.name, host.runs(target))
    bits, registers = row.vector_bits, row.vector_registers
    return TargetRow(target.name, row.text, bits, registers, row.mca_cpu, tested)


def how_tested(target: Target, host: str, runs: bool) -> str:
    """How kernels for a target can be tested on the machine whose CPU is `host`."""
    if target.name == host:
        return "timed"
    if runs:
        return "run"
    if not compilers_for(target):
        return "not compiled"
    return "run under emulation" if emulator_for(target) else "compiled only"


def impacts() -> tuple[ImpactRow, ...]:
    """What may collide."""
    return tuple(
        ImpactRow(
            name=impact.name,
            what=impact.text,
            parameters=tuple(parameter.name for parameter in impact.parameters),
            models=tuple(model.name for model in impact.model_table()),
        )
        for impact in all_impacts.IMPACTS
    )


def scenes(impact: str = all_impacts.DEFAULT) -> tuple[SceneRow, ...]:
    """What may be known of a shot. Raises InputError where there is no such impact."""
    found = all_impacts.find_impact(impact).scene_table().values()
    return tuple(
        SceneRow(s.name, s.text, {str(k): v for k, v in s.fixed.items()}, s.model, s.max_error)
        for s in found
    )


def models(impact: str = all_impacts.DEFAULT) -> tuple[ModelRow, ...]:
    """The contact models. Raises InputError where there is no such impact."""
    found = all_impacts.find_impact(impact).model_table()
    return tuple(ModelRow(m.name, asdict(m.terms), m.text) for m in found)


def variants() -> Variants:
    """The options of kernels, the lanes of vectors, what is refused, and the presets."""
    presets = all_impacts.find_impact(all_impacts.DEFAULT).part("presets").PRESETS
    return Variants(
        axes=tuple(ChoiceRow(a.key, c.code, c.text) for a in AXES for c in a.choices),
        lanes=tuple(
            LanesRow(each.name, each.lanes("double"), each.lanes("float"), each.text)
            for each in INSTRUCTION_SETS
        ),
        rules=tuple(RuleRow(rule.name, rule.reason) for rule in RULES),
        presets=tuple(PresetRow(p.name, p.text, p.options) for p in presets),
    )
