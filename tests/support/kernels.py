"""What several tests need: legal variants, built and verified."""

from __future__ import annotations

import random
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from generator.emission.kernel_source import KernelSource, emit
from generator.errors import KernelError
from generator.evidence.timing.bench_tool import ROOT, BenchTool, build_bench_tool
from generator.evidence.verification.errors import Array
from generator.evidence.verification.worst_estimates import at_worst
from generator.impacts.ball_ball.evidence import MODELS
from generator.impacts.ball_ball.evidence.fixed_steps import euler_verdict
from generator.places import cache_folder
from generator.registry.axes import axes_of
from generator.registry.names import name_of
from generator.registry.rules import broken_rule
from generator.registry.variant import Variant, fixed_steps, make_variant
from generator.targets.target import find_target
from generator.toolchain.build import BuildJob, BuiltLibrary, build_many
from generator.toolchain.compilers import Compiler, find_compilers
from generator.toolchain.flags import compile_flags
from tests.support.reference import load_reference

EULER = fixed_steps(1000)
WARNINGS = ("-Wall", "-Wextra", "-Werror")
CACHE = ROOT / "build" / "test-kernels"


def bench_tool() -> BenchTool:
    return build_bench_tool(cache_folder())


def variant(target: str = "x86-64-v3", model: str = "pooltool", **options: str) -> Variant:
    return make_variant(target, "any", model, EULER, **options)


def is_legal(candidate: Variant) -> bool:
    return broken_rule(candidate, find_target(candidate.target)) is None


def random_variants(seed: int, count: int, targets: tuple[str, ...]) -> list[Variant]:
    """Different legal variants, options, target and model drawn with a seed."""
    rng, found = random.Random(seed), {}
    axes = [a for a in axes_of("fixed") if a.key not in ("compiler", "flags")]
    compilers = [c.code for c in find_compilers()]
    while len(found) < count:
        options = {a.key: rng.choice(a.codes()) for a in axes}
        options["compiler"] = rng.choice(compilers)
        if len(found) % 8 < 2:  # rare among what is legal
            options["simd"] = ("balls", "slips")[len(found) % 8]
        drawn = variant(rng.choice(targets), rng.choice(MODELS), **options)
        if is_legal(drawn):
            found[name_of(drawn)] = drawn
    return list(found.values())


def neighbours(base: Variant) -> list[Variant]:
    """All variants that differ from `base` in one option, legal or not."""
    return [
        base.with_options(**{key: code})
        for key, chosen in base.options
        for code in next(a for a in axes_of("fixed") if a.key == key).codes()
        if code != chosen
    ]


def compiler_of(candidate: Variant) -> Compiler:
    found = {c.code: c for c in find_compilers()}
    return found.get(candidate["compiler"], next(iter(found.values())))


def build_all(variants: list[Variant], worst: bool = False) -> list[BuiltLibrary | KernelError]:
    """Built with warnings as errors, besides their own flags; `worst`: to run under a pattern of
    estimates (verification.worst_estimates)."""
    jobs = [job_of(each) for each in variants]
    return build_many([at_worst(job) for job in jobs] if worst else jobs, CACHE)


def job_of(variant: Variant, source: KernelSource | None = None) -> BuildJob:
    """How a variant is built; its text need not be laid out for that."""
    source, compiler = source or emit(variant, laid_out=False), compiler_of(variant)
    flags = (*compile_flags(variant, compiler, find_target(variant.target)), *WARNINGS)
    return BuildJob(name_of(variant), source.files, compiler, flags)


@dataclass(frozen=True)
class Cases:
    """Cases and what must come out of them, by model."""

    rows: Array
    euler: dict[str, Array]
    exact: dict[str, Array]


def expected_cases(tool: BenchTool, seed: int, count: int) -> Cases:
    """The reference and as many random cases."""
    made = tool.make_cases(seed, count, mixed=False).rows
    rows = np.vstack([load_reference().cases, made])
    euler = {m: tool.expect(rows, "euler", m) for m in MODELS}
    exact = {m: tool.expect(rows, "exact", m) for m in MODELS}
    return Cases(rows, euler, exact)


def failures(tool: BenchTool, variants: list[Variant], cases: Cases) -> list[str]:
    """A line for each variant that does not compile or does not verify."""
    lines, worst, flips = [], 0.0, 0
    for each, built in zip(variants, build_all(variants), strict=True):
        if isinstance(built, KernelError):
            lines.append(str(built))
            continue
        got = tool.run_kernel(built.path, cases.rows)
        euler, exact = cases.euler[each.model], cases.exact[each.model]
        verdict = euler_verdict(cases.rows, got, euler, exact, 1000)
        worst, flips = max(worst, verdict.max_abs_error), max(flips, len(verdict.flips))
        if not verdict.passed:
            lines.append(f"{name_of(each)}: {verdict.reason}")
    print(f"{len(variants)} variants, largest error {worst:.2g} m/s, at most {flips} flips")
    return lines


def compile_alone(
    source: KernelSource | Path, compiler: str, folder: Path, *flags: str
) -> subprocess.CompletedProcess[str]:
    """A kernel as a user compiles it: no flag but those given."""
    if isinstance(source, Path):
        path, include = source, source.parent
    else:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "carom.h").write_text(source.header, encoding="utf-8")
        path, include = folder / "kernel.cpp", folder
        path.write_text(source.source, encoding="utf-8")
    command = [compiler, "-std=c++17", *WARNINGS, *flags, f"-I{include}", "-c", str(path)]
    command += ["-o", str(folder / "kernel.o")]
    return subprocess.run(command, capture_output=True, text=True, timeout=900)
