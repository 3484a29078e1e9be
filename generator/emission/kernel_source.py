"""From a variant to the text of its kernel and its header."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, replace

from ..impacts.impact import Impact
from ..impacts.registry import find_impact
from ..impacts.scene import BaseScene
from ..lowering import isa
from ..lowering.counts import OperationCounts
from ..lowering.text_counts import operations_in
from ..registry.names import source_name_of, source_recipe_of
from ..registry.rules import require_legal
from ..registry.variant import Variant
from ..targets.target import Target, target_or_port
from .banner import Banner, bannered, impact_modules
from .context import KernelContext, KernelHead, Naming, kernels_of
from .environment import environment
from .formatting import format_source
from .header import Section, emit_header
from .marks import without_marks
from .parameters import fields_of
from .unused import without_unused

_PLAIN = Naming()
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

    @property
    def files(self) -> dict[str, str]:
        """What is compiled."""
        return {"carom.h": self.header, "kernel.cpp": self.source, "probe.cpp": self.probe}


def _head(variant: Variant, naming: Naming) -> KernelHead:
    impact = find_impact(variant.question.impact)
    target, scene = target_or_port(variant.target), impact.find_scene(variant.scene)
    require_legal(variant, target)
    begin, end = isa.pragmas(target, contract=variant["fma"] == "autofma")
    fields = fields_of(impact, scene)
    low, high = scene.range_of(impact.functions.varied)
    return KernelHead(
        name=source_name_of(variant),
        naming=naming,
        impact=impact,
        target=target,
        scene=scene,
        variant=variant,
        refusal=isa.refusal(target),
        includes=("limits", *isa.intrinsics_headers(target)),
        pragmas_begin=begin,
        pragmas_end=end,
        fixed=fields.fixed,
        free=fields.free,
        fields=fields.given,
        checks=fields.checks,
        varied_range=(repr(low), repr(high)),
    )


def _wrapped(*sentences: str) -> tuple[str, ...]:
    return tuple(part for line in sentences for part in textwrap.wrap(line, 96))


def emit(
    variant: Variant,
    naming: Naming = _PLAIN,
    command: str | None = None,
    grounds: str = "",
    laid_out: bool = True,
) -> KernelSource:
    """The text of a kernel, its header and its probe. ValueError where the variant is illegal.

    `grounds`: what its choice rests on, for the banner. `laid_out` False: for a compiler alone.
    """
    head = _head(variant, naming)
    impact, scene = head.impact, head.scene
    context = kernels_of(impact).context(head)
    sentences = impact.words().contract(scene, variant.model, context.method)
    context = replace(context, contract=_wrapped(*sentences))
    marked = _text(context, command, grounds)
    source = without_unused(without_marks(marked))
    if laid_out:
        source = format_source(source, variant.question.file)
    return KernelSource(
        variant=variant,
        source_name=head.name,
        header=emit_header(impact, scene, naming.prefix, command),
        source=source,
        probe=emit_probe(impact, scene, naming.prefix, head.fixed_step),
        counts=context.counts,
        text_counts=operations_in(source),
        marked=marked,
    )


def _text(context: KernelContext, command: str | None, grounds: str) -> str:
    variant, name = context.variant, context.name
    data = (
        name,
        repr(context.naming),
        *_data_of(context.target),
        context.scene.model_dump_json(),
        *impact_modules(context.impact.folder),
    )
    rows = {
        "question": str(variant.question),
        "recipe": source_recipe_of(variant),
        "counts": f"{context.counts.describe()} {_COUNTED[variant.stepper.family]}",
    }

    banner = Banner(rows, command or f"./gen emit {name}", data, grounds=grounds)

    def filled(k: KernelContext) -> str:
        shown = {"k": k, **k.shown}
        return bannered("kernel.cpp.j2", shown, banner)

    text = filled(context)
    if line := isa.estimates_line(text):
        text = filled(replace(context, contract=context.contract + _wrapped(line)))
    return text


def _data_of(target: Target) -> tuple[str, ...]:
    return target.row.model_dump_json(), *sorted(target.features)


def emit_probe(impact: Impact, scene: BaseScene, prefix: str, fixed_step: bool) -> str:
    """The adapter through which bench/ calls any scene's kernel with all parameters of a case."""
    section, words = Section(impact, scene, prefix), impact.words()
    values = [(f.name, words.case_value(f.name, "given")) for f in section.fields]
    template = environment().get_template("probe.cpp.j2")
    return template.render(k=section, values=values, fixed_step=fixed_step)
