"""One kernel under the tools of `profiling`; what a tool cannot do is said."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from ...choice.kernel import Emitted
from ...choice.workbench import Workbench
from ...emission.kernel_source import emit
from ...errors import KernelError
from ...evidence.profiling.counting import KINDS, Counted, count_operations
from ...evidence.profiling.misses import simulate_misses
from ...evidence.profiling.sampling import Sampled, sample
from ...evidence.verification.errors import Array
from ...registry.rules import broken_rule
from ...registry.variant import Variant
from ...targets.host import Host
from ...targets.target import Target, find_target
from ...toolchain.build import build_library
from ...toolchain.compilers import Compiler
from ...toolchain.flags import compile_flags
from ..findings import Counts, MissFigures, SectionShares

SIMULATED = ("x86-64-v3", "x86-64-v2")  # what valgrind can run, the first that it does run
Made = TypeVar("Made")


@dataclass(frozen=True)
class Profile:
    """What the tools found of a kernel."""

    counts: Counts | None
    each: tuple[int, ...]  # evaluations of each verified case
    sections: SectionShares | None
    misses: tuple[MissFigures, ...]
    missing: dict[str, str]


def profile(
    bench: Workbench,
    candidate: Emitted,
    host: Host,
    verified: Array,
    timed: Array,
    seconds: float,
) -> Profile:
    """Counts on the timed cases, evaluations on the verified ones, sections, misses."""
    missing: dict[str, str] = {}
    cache = bench.cache / "kernels"

    def attempt(what: str, make: Callable[[], Made]) -> Made | None:
        try:
            return make()
        except KernelError as error:
            missing[what] = str(error)
            return None

    counter = next(iter(bench.compilers.values()))

    def count(cases: Array, apart: bool = False) -> Counted:
        flags = ("-std=c++17", "-O1", *_march(candidate.flags))
        return count_operations(candidate.source, counter, flags, cases, cache, apart)

    exact = candidate.variant.stepper.budget is not None
    counted = attempt("counts", lambda: count(timed))
    stated = attempt("counts", lambda: count(timed[:64], apart=exact))
    each = attempt("evaluations", lambda: count(verified).each)
    found = attempt(
        "sections",
        lambda: sample(
            candidate.source, candidate.compiler, candidate.flags, timed, seconds, cache
        ),
    )
    misses = list(_by_hardware(found, host))
    if not misses:
        simulated = attempt("misses", lambda: _simulated(bench, candidate, timed[:256]))
        misses += [simulated] if simulated else []
    if found and not found.counters:
        missing["hardware counters"] = found.no_counters
    return Profile(
        counts=_counts(counted, stated, candidate) if counted and stated else None,
        each=each or (),
        sections=_sections(found),
        misses=tuple(misses),
        missing=missing,
    )


def _march(flags: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(flag for flag in flags if flag.startswith("-march="))


def _counts(counted: Counted, stated: Counted, candidate: Emitted) -> Counts:
    usual = stated.per_iteration
    total, n = counted.total.as_dict(), max(counted.collisions, 1)
    kinds = [kind for kind in KINDS if kind in total]
    return Counts(
        per_collision={kind: total[kind] / n for kind in kinds},
        per_step={kind: usual.as_dict()[kind] for kind in kinds} if usual else {},
        stated=candidate.source.counts.describe(),
        evaluations=counted.evaluations / n,
        flops=counted.flops_per_collision,
        refused=counted.rare_share,
    )


def _sections(found: Sampled | None) -> SectionShares | None:
    if found is None:
        return None
    return SectionShares(shares=dict(found.shares), unknown=found.unknown, samples=found.samples)


def _by_hardware(found: Sampled | None, host: Host) -> list[MissFigures]:
    if found is None or not found.counters:
        return []
    return [
        MissFigures(
            source="hardware counters",
            by=host.cpu,
            built_for=host.target.name,
            events=dict(found.counters),
        )
    ]


def _simulated(bench: Workbench, candidate: Emitted, cases: Array) -> MissFigures:
    """By valgrind, as built for the best target that it can run."""
    refused = []
    for name in SIMULATED:
        target = find_target(name)
        variant = candidate.variant.moved(target=name)
        if not target.has("fma"):
            variant = variant.with_options(fma="nofma")
        if (rule := broken_rule(variant, target)) is not None:
            refused.append(f"{name}: {rule.reason}")
            continue
        try:
            library = _built(bench, candidate.compiler, variant, target)
            found = simulate_misses(bench.tool.executable, library, cases)
        except KernelError as error:
            refused.append(f"{name}: {error}")
            continue
        return MissFigures(
            source="valgrind's simulation",
            by=found.version,
            built_for=name,
            events=dict(found.events),
        )
    raise KernelError("; ".join(refused))


def _built(bench: Workbench, compiler: Compiler, variant: Variant, target: Target) -> Path:
    """A variant's library for another target than the bench's candidates have."""
    source = emit(variant)
    files = {"carom.h": source.header, "kernel.cpp": source.source, "probe.cpp": source.probe}
    flags = compile_flags(variant, compiler, target)
    return build_library(files, (), compiler, flags, bench.cache / "kernels").path
