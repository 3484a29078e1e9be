"""The text of one kernel, and what it is made of."""

from __future__ import annotations

from dataclasses import dataclass

from ..choice.lookup import entries_for
from ..emission.header import emit_header
from ..emission.kernel_source import KernelSource
from ..emission.kernel_source import emit as emit_variant
from ..errors import InputError
from ..impacts.derivation import Chapter, derivation_of
from ..registry.axes import axis
from ..registry.names import name_of, source_name_of
from ..registry.question import DEFAULT_IMPACT, find_impact
from ..registry.variant import Variant, fixed_steps, make_variant
from ..targets.target import find_target
from .request import kernel_named
from .session import Session


def emit(kernel: str, session: Session | None = None) -> str:
    """The text of a kernel: of a question, or its file, and a recipe; without one, the chosen one.

    Where it was chosen these are the bytes in `generated/`; nothing is compiled or timed. Raises
    InputError where there is no such kernel.
    """
    session = session or Session()
    variant = kernel_named(kernel, session)
    name, chosen = source_name_of(variant), entries_for(session.generated, variant.question)
    grounds = [entry.grounds for entry in chosen if source_name_of(entry.variant) == name]
    return _source(variant, kernel, grounds[0] if grounds else "").source


def header(scene: str) -> str:
    """The text of `carom.h` for a scene, or `IMPACT/SCENE`. InputError where there is none such."""
    impact, _, name = scene.rpartition("/")
    of = find_impact(impact or DEFAULT_IMPACT)
    return emit_header(of, of.find_scene(name))


def _source(variant: Variant, kernel: str, grounds: str = "") -> KernelSource:
    try:
        return emit_variant(variant, grounds=grounds)
    except ValueError as error:
        raise InputError(f"{kernel}: {error}") from None


@dataclass(frozen=True)
class Explanation:
    """What a kernel is made of.

    `exact`: is it an exact kernel, of fewer and longer steps? `legend`: symbols of the derivation
    and their meanings. `options`: key, code and meaning of each. `counts`: the operations of one
    step, in words; `flops`: their number, an FMA being two.
    """

    kernel: str
    exact: bool
    legend: tuple[tuple[str, str], ...]
    options: tuple[tuple[str, str, str], ...]
    derivation: tuple[Chapter, ...]
    counts: str
    flops: int


def explain(
    kernel: str,
    target: str = "x86-64-v3",
    model: str | None = None,
    session: Session | None = None,
) -> Explanation:
    """Explain a kernel: its name, options, derivation and operation counts.

    `kernel`: as for `emit`, or a preset, for a `target` and contact `model` then (None: the default
    one). Raises InputError where there is no such kernel.
    """
    variant = _find(kernel, target, model, session or Session())
    source, derived = _source(variant, kernel), derivation_of(variant.question.row)
    meanings = tuple(
        (key, code, next(c.text for c in axis(key).choices if c.code == code))
        for key, code in variant.options
    )
    return Explanation(
        kernel=name_of(variant),
        exact=variant.stepper.family == "exact",
        legend=derived.LEGEND,
        options=meanings,
        derivation=derived.derivation(variant.question.row.find_model(variant.model)),
        counts=source.counts.describe(),
        flops=source.counts.flops,
    )


def _find(kernel: str, target: str, model: str | None, session: Session) -> Variant:
    if "/" in kernel:
        return kernel_named(kernel, session)
    find_target(target)
    impact = find_impact(DEFAULT_IMPACT)
    name = impact.find_model(model or impact.default_model).name
    return make_variant(
        target, "any", name, fixed_steps(1000), **impact.part("presets").find_preset(kernel).options
    )
