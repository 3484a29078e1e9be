"""The kernel to use for a request: the chosen one, or the default where none was chosen yet."""

from __future__ import annotations

from pathlib import Path

from generator.choice.selection import read_selection
from generator.errors import KernelError
from generator.targets.host import Host
from generator.targets.target import Target
from generator.variants.names import variant_of
from generator.variants.presets import find_preset
from generator.variants.variant import Stepper, Variant, make_variant


def kernel_for(
    generated: Path, target_name: str, target: Target, scene: str, model: str, steps: int
) -> Variant:
    """A fixed-step kernel for a model: from selection.json, else our best-known options."""
    for name in (target_name, target.name):
        selection = read_selection(generated / name / scene)
        if selection is not None and selection.resolved == target.name:
            entry = selection.find(model, steps=steps)
            if entry is not None:
                return variant_of(entry.kernel)
    return default_kernel(target, scene, model, Stepper("euler", steps=steps))


def default_kernel(target: Target, scene: str, model: str, stepper: Stepper) -> Variant:
    """What is used before anything was timed."""
    options = dict(find_preset("reduced-ahead").options)
    options["fma"] = "fma" if target.has("fma") else "nofma"
    return make_variant(target.name, scene, model, stepper, **options)


def with_compiler_found(variant: Variant, compilers: dict[str, object]) -> Variant:
    """The same kernel by another compiler where its own is not here."""
    if variant["compiler"] in compilers:
        return variant
    return variant.with_options(compiler=next(iter(compilers)))


def require_runs(host: Host, target: Target) -> None:
    """Raise KernelError where a target's code cannot run on this machine."""
    if not host.runs(target):
        lacks = ", ".join(sorted(target.features - host.features)) or target.row.arch
        raise KernelError(f"{target.name} code cannot run here: this CPU lacks {lacks}")
