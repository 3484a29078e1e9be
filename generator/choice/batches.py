"""Batches: for a chosen kernel, which lanes its batch function should have."""

from __future__ import annotations

from generator.choice.candidates import batch_candidates
from generator.choice.choose import Choice, choose_by_model, choose_by_time, choose_first
from generator.choice.job import STEPS, verify
from generator.choice.modelling import model_all, model_loop
from generator.choice.workbench import VERIFY_RANDOM, VERIFY_SEED, Candidate, Workbench
from generator.targets.host import Host
from generator.targets.target import Target


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
    if runs_here or bench.emulated is not None:
        expected = bench.expected(scene, model, STEPS, VERIFY_SEED, VERIFY_RANDOM)
        verify(bench, candidates, expected)
        if all(c.rejected for c in wide):
            return None
    if runs_here:
        run = bench.time(candidates, candidates[0], scene, seconds, batches=True)
    if runs_here and host.target.name == target.name and host.exact:
        return candidates, candidates[0], choose_by_time(wide, run, host.target.name)
    exact = single.variant.stepper.family == "exact"
    if exact and bench.emulated is None:
        # How many passes their lanes take is known where they run alone: here, if anywhere.
        chosen = choose_by_time(wide, run, host.target.name) if runs_here else None
        return candidates, candidates[0], chosen or choose_first(wide, target.name)
    model_all(bench, candidates[:2], target, bench.timing_cases(scene, model))
    if exact:
        model_all(bench, wide, target, bench.batch_cases(scene, model))
    else:
        for candidate in wide:
            if not candidate.rejected:
                model_loop(bench, candidate, target)
    return candidates, candidates[0], choose_by_model(wide, target.row.mca_cpu)
