"""The main job of a contest: its seeds, verified, timed or modelled, and one chosen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..registry.names import name_of
from ..registry.question import Contest
from ..registry.rules import broken_rule
from ..registry.variant import Variant
from ..targets.host import Host
from ..targets.target import find_target
from .candidates import baseline
from .choose import Choice, choose_by_time
from .kernel import Rejected, Verified
from .recorded import choose_elsewhere
from .seeds import recorded_of, seeds_of
from .sought import Entries, choose_sought
from .timing import Together, job_of, timed_together
from .trials import job_key
from .workbench import TimingJob, Workbench

STEPS = 1000


@dataclass(frozen=True)
class Held:
    """A contest that was held: every kernel as far as it came, the baseline first."""

    contest: Contest
    kernels: Entries
    choice: Choice


def hold(bench: Workbench, contest: Contest, host: Host, seconds: float) -> Held:
    """The contest of single calls. Raises KernelError where no candidate passes."""
    first = _baseline(bench, contest)
    known = [first, *seeds_of(contest, _codes(bench), (), bench.reproducible)]
    known += recorded_of(contest, bench.timings, ())
    kernels = _verified(bench, contest, _legal(bench, contest, known))
    answers = first.question.goal == contest.goal  # only then may the baseline itself be chosen
    choice = _judged(bench, contest, host, kernels, 0 if answers else 1, seconds)
    return Held(contest, *choice)


def hold_batches(bench: Workbench, singles: Held, host: Host, seconds: float) -> Held | None:
    """The contest of batches about the kernel chosen for single calls, which comes second.

    None where the target or the stepper has no lanes, or where none of them verified.
    """
    contest, single = replace(singles.contest, call="batch"), singles.choice.chosen.variant
    wide = seeds_of(contest, _codes(bench), [single], bench.reproducible)
    if not wide:
        return None
    wide = _legal(bench, contest, [*wide, *recorded_of(contest, bench.timings, [single])])
    kernels = _verified(bench, contest, [_baseline(bench, contest), single, *wide])
    if all(isinstance(kernel, Rejected) for kernel in kernels[2:]):
        return None
    return Held(contest, *_judged(bench, contest, host, kernels, 2, seconds))


def _codes(bench: Workbench) -> list[str]:
    return list(bench.compilers)


def _baseline(bench: Workbench, contest: Contest) -> Variant:
    return baseline(contest, _codes(bench))


def _legal(bench: Workbench, contest: Contest, variants: Sequence[Variant]) -> list[Variant]:
    """Each once, by the compilers that are here, without those that break a rule."""
    there, target = [v for v in variants if v["compiler"] in bench.compilers], contest.target
    legal = [v for v in there if broken_rule(v, find_target(target)) is None]
    return list({name_of(v): v for v in legal}.values())


def _verified(
    bench: Workbench, contest: Contest, variants: Sequence[Variant]
) -> list[Verified | Rejected]:
    return bench.verify_all(bench.build_all(bench.emit_all(variants, find_target(contest.target))))


def _judged(
    bench: Workbench,
    contest: Contest,
    host: Host,
    kernels: list[Verified | Rejected],
    among: int,
    seconds: float,
) -> tuple[Entries, Choice]:
    """Timed where this is the target's CPU alone; else by records of such a CPU, and llvm-mca.

    `among`: the number of the first kernel that may be chosen.
    """
    if host.is_a(find_target(contest.target)):
        made = _timed(bench, contest, host, job_of(kernels, seconds))
        return choose_sought(
            bench,
            made.told(kernels),
            lambda some: (some, choose_by_time(some[among:], made.rounds, host)),
        )
    return choose_sought(bench, kernels, lambda some: choose_elsewhere(bench, contest, some, among))


def _timed(bench: Workbench, contest: Contest, host: Host, job: TimingJob) -> Together:
    """The kernels of a job, interleaved; or as it was kept."""
    rules = bench.rules(contest, f"{host.target.name}, {host.cpu}")
    depends = [
        rules.depends(k.code, k.variant.question.goal, job.baseline.code, f"{job.seconds:g} s")
        for k in job.kernels
    ]

    def make() -> dict[str, Any]:
        made = timed_together(bench.time, job, bench.progress)
        ended = {rejected.name: [rejected.reason, rejected.text] for rejected in made.ended}
        return {"processes": made.processes, "ended": ended}

    names = {kernel.name: kernel for kernel in job.kernels}
    kept = bench.store.kept("timings", job_key(["main job", list(names)], depends), make)
    bench.progress("timing", 1, 1)
    ended = tuple(Rejected(names[name], *why) for name, why in kept["ended"].items())
    return Together(tuple(kept["processes"]), ended)
