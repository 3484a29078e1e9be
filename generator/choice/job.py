"""The main job of a contest: its seeds, verified, timed or modelled, and one chosen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..errors import KernelError
from ..evidence.timing.ratios import timing_results
from ..registry.names import name_of
from ..registry.question import Contest
from ..registry.rules import broken_rule
from ..registry.variant import Variant
from ..targets.host import Host
from ..targets.target import find_target
from .candidates import baseline
from .choose import Choice, choose_by_time
from .kernel import Built, Rejected, Verified
from .recorded import choose_elsewhere
from .seeds import recorded_of, seeds_of
from .sought import Entries, choose_sought
from .timing import PROCESSES, Together, timed_together
from .trials import job_key
from .workbench import TimingJob, Workbench

STEPS = 1000
ROUNDS = 1000  # at most, in each process; the seconds end a timing before


@dataclass(frozen=True)
class Held:
    """A contest that was held: every kernel as far as it came, the baseline first."""

    contest: Contest
    kernels: Entries
    choice: Choice


def hold(bench: Workbench, contest: Contest, host: Host, seconds: float) -> Held:
    """The contest of single calls. Raises KernelError where no candidate passes."""
    known = [_baseline(bench, contest), *seeds_of(contest, _codes(bench), (), bench.reproducible)]
    known += recorded_of(contest, bench.timings, ())
    kernels = _verified(bench, contest, _legal(bench, contest, known))
    choice = _judged(bench, contest, host, kernels, 0, seconds)
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
        made = _timed(bench, contest, host, kernels, seconds)
        rounds, ended = made.rounds, {rejected.name: rejected for rejected in made.ended}
        results = {result.name: result for result in timing_results(rounds.whole)}
        timed = [
            k if isinstance(k, Rejected) else ended.get(k.name) or k.timed(results[k.name])
            for k in kernels
        ]
        return choose_sought(
            bench, timed, lambda some: (some, choose_by_time(some[among:], rounds, host))
        )

    return choose_sought(bench, kernels, lambda some: choose_elsewhere(bench, contest, some, among))


def _timed(
    bench: Workbench,
    contest: Contest,
    host: Host,
    kernels: Sequence[Verified | Rejected],
    seconds: float,
) -> Together:
    """All that passed and the baseline, interleaved; or as it was kept."""
    passed = [k for k in kernels if not isinstance(k, Rejected)]
    first = kernels[0].emitted
    if not passed or not isinstance(first, Built):
        reasons = sorted({k.text for k in kernels if isinstance(k, Rejected)})
        raise KernelError(f"no candidate passed verification: {'; '.join(reasons[:3])}")
    unique = {k.name: k for k in [first, *passed]}
    job = TimingJob(tuple(unique.values()), ROUNDS, seconds / PROCESSES, latency=True)
    rules = bench.rules(contest, f"{host.target.name}, {host.cpu}")
    depends = [
        rules.depends(k.code, k.variant.question.goal, first.code, f"{seconds:g} s")
        for k in unique.values()
    ]
    what = f"timing {len(unique)} kernels for {seconds:.0f} s"

    def make() -> dict[str, Any]:
        made = timed_together(bench.time, job, lambda _, n: bench.progress(what, n - 1, PROCESSES))
        ended = {rejected.name: [rejected.reason, rejected.text] for rejected in made.ended}
        return {"processes": made.processes, "ended": ended}

    key = job_key(["main job", list(unique)], depends)
    kept = bench.store.kept("timings", key, make)
    bench.progress("timing", PROCESSES, PROCESSES)
    ended = tuple(Rejected(unique[name], *why) for name, why in kept["ended"].items())
    return Together(tuple(kept["processes"]), ended)
