"""Batches: for a chosen kernel, which lanes its batch function should have."""

from __future__ import annotations

from dataclasses import asdict

from generator.choice.candidates import batch_candidates
from generator.choice.choose import Choice, choose_by_model, choose_by_time, choose_first
from generator.choice.job import STEPS
from generator.choice.modelling import model_all
from generator.choice.store import key_of
from generator.choice.workbench import VERIFY_RANDOM, VERIFY_SEED, Candidate, Workbench
from generator.errors import KernelError
from generator.targets.host import Host
from generator.targets.target import Target
from generator.toolchain.mca import McaReport, analyse, assembly_of, require_mca
from generator.toolchain.replay import Modelled
from generator.variants.variant import Variant

REGION = "lanes"  # the name of the marked loop in batch kernels


def batch_job(
    bench: Workbench,
    target: Target,
    host: Host,
    scene: str,
    first: Candidate,
    single: Candidate,
    seconds: float,
) -> tuple[list[Candidate], Candidate, Choice] | None:
    """Candidates (the baseline `first`, the chosen `single`, then lanes), baseline and choice.

    None where the target or the stepper has no lanes, or where none of them verified.
    """
    variants = batch_candidates(single.variant, target, list(bench.compilers))
    if not variants:
        return None
    candidates = bench.prepare([first.variant, single.variant, *variants], target)
    bench.compile(candidates)
    wide = candidates[2:]
    model = single.variant.model
    runs_here = host.runs(target)
    if runs_here:
        bench.verify(candidates, bench.expected(scene, model, STEPS, VERIFY_SEED, VERIFY_RANDOM))
        run = bench.time(candidates, candidates[0], scene, seconds, batches=True)
        if all(c.rejected for c in wide):
            return None
    if runs_here and host.target.name == target.name and host.exact:
        return candidates, candidates[0], choose_by_time(wide, run, host.target.name)
    if single.variant.stepper.family == "exact":
        # How many passes their lanes take is known where they run alone: here, if anywhere.
        chosen = choose_by_time(wide, run, host.target.name) if runs_here else None
        return candidates, candidates[0], chosen or choose_first(wide, target.name)
    model_all(bench, candidates[:2], target, bench.timing_cases(scene, model))
    for candidate in wide:
        if not candidate.rejected:
            _model_loop(bench, candidate, target)
    return candidates, candidates[0], choose_by_model(wide, target.row.mca_cpu)


def loop_report(bench: Workbench, candidate: Candidate, target: Target) -> McaReport:
    """What llvm-mca says of one pass of the loop over all lanes in flight. Raises KernelError."""
    sources = {k: v for k, v in candidate.sources.items() if k != "probe.cpp"}
    compiler, flags = candidate.compiler, candidate.flags

    def make() -> dict[str, object]:
        text = assembly_of(sources, (), compiler, flags, candidate.name)
        return asdict(analyse(text, target, REGION))

    texts = sorted(sources.items())
    key = key_of(texts, compiler.version, flags, require_mca().version, target.row.mca_cpu, REGION)
    kept = bench.store.kept("llvm-mca figures", key, make)
    return McaReport(**{**kept, "path_cycles": tuple(kept["path_cycles"])})


def lanes_in_flight(variant: Variant) -> int:
    """Lanes of all vectors that are worked on in turn."""
    return variant.width * int(variant["interleave"][1:])


def _model_loop(bench: Workbench, candidate: Candidate, target: Target) -> None:
    variant = candidate.variant
    steps = variant.stepper.steps
    assert steps is not None
    try:
        report = loop_report(bench, candidate, target)
    except KernelError as error:
        candidate.rejected = f"llvm-mca: {error}"
        return
    passes = steps / lanes_in_flight(variant)
    candidate.modelled = Modelled(
        cpu=target.row.mca_cpu,
        cycles=report.cycles_per_iteration * passes,
        instructions=report.uops * passes,
        cases=0,
        steps=steps,
        version=require_mca().version,
    )
