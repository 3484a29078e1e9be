"""A kernel on CPUs that are not here, by llvm-mca; what cannot be modelled says why."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from typing import Any

from ...choice.kernel import Emitted
from ...choice.modelling import modelled as replayed
from ...choice.workbench import Workbench
from ...errors import InputError, KernelError
from ...evidence.records.code import key_of
from ...evidence.verification.errors import Array
from ...registry.rules import broken_rule
from ...registry.variant import Variant
from ...targets.host import Host
from ...targets.target import Target, targets
from ...toolchain.loops import marked_loops
from ...toolchain.mca import analyse, assembly_of, require_mca
from ..findings import Modelled

REPLAYED = 16  # collisions, of each kernel on each target
_UNITS = 6  # of a CPU, the busiest ones


def modelled(bench: Workbench, variant: Variant, host: Host, cases: Array) -> tuple[Modelled, ...]:
    """llvm-mca's figures for a variant on every target, side by side.

    `cases`: those that kernels are timed on; a few of them are replayed.
    """
    prepared = [(target, *_prepared(bench, variant, target)) for target in targets().values()]

    def one(row: tuple[Target, Emitted | None, str]) -> Modelled:
        return _modelled(bench, *row, host, cases[:REPLAYED])

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return tuple(pool.map(one, prepared))


def _prepared(bench: Workbench, variant: Variant, target: Target) -> tuple[Emitted | None, str]:
    """The variant for a target, or why there is none; by Clang where its own compiler cannot."""
    own = variant.moved(target=target.name)
    if not target.has("fma"):
        own = own.with_options(fma="nofma")
    if (rule := broken_rule(own, target)) is not None:
        return None, rule.reason
    reason = ""
    for code in dict.fromkeys((own["compiler"], "clang")):  # which makes code for all of them
        if code not in bench.compilers:
            continue
        try:
            candidate = bench.emit(own.with_options(compiler=code), target)
        except (KernelError, InputError, ValueError) as error:
            reason = reason or str(error)
        else:
            return candidate, reason and f"by {code}: {reason}"
    return None, reason


def _modelled(
    bench: Workbench,
    target: Target,
    candidate: Emitted | None,
    reason: str,
    host: Host,
    cases: Array,
) -> Modelled:
    known: dict[str, Any] = dict.fromkeys(("cycles", "bound", "uops", "ipc", "collision"))
    known |= {"bottleneck": "", "pressure": ()}
    notes = [reason] if reason else []
    if candidate is not None:
        try:
            known |= _loop_figures(bench, candidate, target)
        except KernelError as error:
            notes.append(str(error))
        try:
            known["collision"] = _replayed(bench, candidate, target, host, cases)
        except KernelError as error:
            notes.append(str(error))
    notes += [known.pop("note")] if "note" in known else []
    return Modelled(target=target.name, cpu=target.row.mca_cpu, note="; ".join(notes), **known)


def _replayed(
    bench: Workbench, candidate: Emitted, target: Target, host: Host, cases: Array
) -> float:
    """Cycles of a mean collision: what runs here, replayed on the target."""
    if not host.runs(target):
        raise KernelError(f"{target.name} code cannot run here, so no collision can be replayed")
    return replayed(bench, candidate, target, cases).cycles


def _loop_figures(bench: Workbench, candidate: Emitted, target: Target) -> dict[str, Any]:
    """Of the marked loop, from the store or made now."""
    compiler, flags = candidate.compiler, candidate.flags
    sources = candidate.with_regions

    def make() -> dict[str, Any]:
        text = assembly_of(sources, (), compiler, flags, candidate.name)
        paths = [path for loop in marked_loops(text, "loop") for path in loop.paths]
        if all(any(line.startswith("call") for line in path.lines) for path in paths):
            raise KernelError(
                f"{compiler.code} made the step a function of its own, which the loop calls and "
                "llvm-mca does not follow"
            )
        return asdict(analyse(text, target))

    tools = (compiler.version, flags, require_mca().version, target.row.mca_cpu)
    key = key_of(sorted(sources.items()), tools, "no calls")
    found = bench.store.kept("llvm-mca loops", key, make)
    return {
        "cycles": found["cycles_per_iteration"],
        "bound": found["throughput_bound"],
        "uops": found["uops"],
        "ipc": found["ipc"],
        "bottleneck": found["bottleneck"],
        "pressure": tuple((name, busy) for name, busy in found["pressure"][:_UNITS]),
        "note": found["note"],
    }
