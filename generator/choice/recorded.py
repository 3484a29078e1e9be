"""A choice for a CPU that is not here: by its records, and by llvm-mca for what has none."""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import KernelError
from ..registry.question import Contest
from ..targets.target import find_target
from ..toolchain.replay import Modelled
from .choose import Choice, choose_by_model, choose_by_records, eligible
from .kernel import Estimated, Rejected, Verified
from .modelling import model_all
from .workbench import Workbench

Weighed = list[Estimated | Rejected]


def choose_elsewhere(
    bench: Workbench, contest: Contest, kernels: Sequence[Verified | Rejected], among: int
) -> tuple[Weighed, Choice]:
    """The kernels with what is known of their times, and the choice from number `among` on.

    llvm-mca's cycles are for those without a record. The baseline, which is the first, and the
    kernel that the records choose are modelled beside these, to compare.
    """
    target = find_target(contest.target)
    known = noted(bench, contest, kernels)
    fit = eligible(known[among:])
    without: list[Estimated] = [k for k in fit if k.record is None]
    none = len(without) == len(fit)
    asked = [k for k in known[:1] if without and isinstance(k, Estimated)]
    if none:
        asked += [k for k in known[among:] if isinstance(k, Estimated)]
    elif without:
        winner = choose_by_records(fit, target).chosen
        asked += [k for k in fit if k.record is None or k.name == winner.name]
    unique = list({k.name: k for k in asked}.values())
    models = model_all(bench, contest, unique)
    weighed = [k if isinstance(k, Rejected) else _with_model(k, models.get(k.name)) for k in known]
    own = models.get(known[0].name)
    cycles = own.cycles if isinstance(own, Modelled) else None
    if none:
        wins, cpu = bench.timings.wins, target.row.mca_cpu
        by = choose_by_model(weighed[among:], cpu, wins, cycles)
        return weighed, by
    return weighed, choose_by_records(weighed[among:], target, bench.timings.lead, cycles)


def _with_model(kernel: Estimated, model: Modelled | KernelError | None) -> Estimated | Rejected:
    """A kernel that was timed needs no model."""
    if not isinstance(model, KernelError):
        return kernel.estimated(kernel.record, model)
    if kernel.record is None:
        return Rejected(kernel, "model", f"llvm-mca: {model}")
    return kernel


def noted(bench: Workbench, contest: Contest, kernels: Sequence[Verified | Rejected]) -> Weighed:
    """Each kernel with the record that tells most of it, if that CPU ever timed it."""
    timed = bool(bench.timings.contests(contest.target))
    rules = bench.rules(contest, contest.target)
    weighed: Weighed = []
    for kernel in kernels:
        if isinstance(kernel, Rejected):
            weighed.append(kernel)
            continue
        found = None
        if timed:
            now = rules.depends(kernel.code, contest.goal, kernels[0].emitted.code)
            found = bench.timings.find(contest.target, kernel.variant, now)
        weighed.append(kernel.estimated(found, None))
    return weighed
