"""The choice: the fastest of what passed; ties go to the fewest options away from the default."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..errors import KernelError
from ..evidence.records.evidence import NEGLIGIBLE, WON, told
from ..evidence.timing.ratios import TimingRun, fastest, ties
from ..evidence.verification.verdict import Verdict
from ..registry.variant import Variant
from ..targets.host import Host
from ..targets.target import Target
from .model_error import MODEL_ERROR, model_band
from .selection import ChosenBy, Selected
from .workbench import Candidate

MODEL_BAND = 0.005  # modelled cycles that differ by less count as a tie where no recipe has won


@dataclass(frozen=True)
class Choice:
    """The kernel that was chosen, those that tie with it, and on what grounds."""

    chosen: Candidate
    ties: tuple[str, ...]
    by: ChosenBy
    measured_on: str
    evidence: str  # for readers: which CPU, when, how many; or which model
    sought: str | None = None  # what a search for errors found of it; None: not searched


def _preferred(tied: Sequence[Candidate]) -> Candidate:
    """The first listed of those with the fewest options away from the default."""
    return min(tied, key=lambda c: c.variant.distance_from_default())


def eligible(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Verified kernels that round as they are written: -Ofast is for the report's rows alone."""
    found = [
        c
        for c in candidates
        if not c.rejected
        and c.verdict is not None
        and c.verdict.passed
        and c.variant.rounds_as_written
    ]
    if not found:
        reasons = "; ".join(sorted({c.rejected for c in candidates if c.rejected})[:3])
        raise KernelError(f"no candidate passed verification: {reasons or 'none was built'}")
    return found


def choose_by_time(candidates: Sequence[Candidate], run: TimingRun, host: Host) -> Choice:
    """Where the target is this host's CPU."""
    timed = {c.name: c for c in eligible(candidates) if c.timing is not None}
    best = fastest(run, timed)
    tied = ties(run, best, timed)
    chosen, name = _preferred([timed[name] for name in tied]), host.target.name
    evidence = f"timed on {host.cpu} ({name}), {run.day}, {len(timed)} kernels"
    return Choice(chosen, tied, "timing", name, evidence)


def choose_by_model(
    candidates: Sequence[Candidate], cpu: str, wins: Callable[[Variant], int] = lambda _: 0
) -> Choice:
    """Where it is not: by the cycles of a collision that llvm-mca replays.

    Of those it cannot tell apart the one whose recipe has won on the most CPUs that were timed;
    the fastest where none has.
    """
    modelled = [c for c in eligible(candidates) if c.modelled is not None]
    if not modelled:
        raise KernelError("llvm-mca gave no figure for any candidate")
    least = min(_cycles(c) for c in modelled)
    near = [c for c in modelled if _cycles(c) <= least * (1 + model_band(c.variant))]
    most = max(wins(c.variant) for c in near)
    tied = near if most else [c for c in near if _cycles(c) <= least * (1 + MODEL_BAND)]
    chosen = _preferred([c for c in tied if wins(c.variant) == most])
    evidence = f"modelled by llvm-mca for {cpu}, {len(modelled)} kernels"
    return Choice(chosen, tuple(c.name for c in tied), "llvm-mca", cpu, evidence)


def choose_by_records(candidates: Sequence[Candidate], target: Target) -> Choice:
    """Where the target's CPU was timed elsewhere: records compete among themselves.

    A kernel that nobody timed takes their winner's place where the model says that it is faster by
    more than the model errs.
    """
    found = eligible(candidates)
    timed = [c for c in found if c.recorded is not None]
    least = min(_recorded(c) for c in timed)
    tied = [c for c in timed if _recorded(c) <= least * WON]
    chosen = _preferred([c for c in tied if _recorded(c) <= least * NEGLIGIBLE])
    rest = [c for c in found if c.recorded is None and c.modelled is not None]
    evidence = told([c.recorded for c in timed if c.recorded is not None], len(rest))
    if chosen.modelled is not None:
        limit = _cycles(chosen) / MODEL_ERROR
        better = [c for c in rest if _cycles(c) < limit]
        if better:
            chosen = min(better, key=_cycles)
            evidence += ", one of which by so much that it is chosen"
            return Choice(chosen, (chosen.name,), "llvm-mca", target.row.mca_cpu, evidence)
    return Choice(chosen, tuple(c.name for c in tied), "records", target.name, evidence)


def found_errors(verdict: Verdict) -> dict[str, float | None]:
    """The errors of an entry: the largest found, and that under the worst root estimates."""
    worst = verdict.worst_estimate_error
    return {
        "max_rel_error": float(f"{verdict.largest_error:.3g}"),
        "worst_estimate_error": None if worst is None else float(f"{worst:.3g}"),
    }


def _cycles(candidate: Candidate) -> float:
    assert candidate.modelled is not None
    return candidate.modelled.cycles


def _recorded(candidate: Candidate) -> float:
    assert candidate.recorded is not None
    return candidate.recorded.record.ratio


def selected(choice: Choice, baseline: Candidate) -> Selected:
    """The choice as an entry of selection.json."""
    chosen, variant = choice.chosen, choice.chosen.variant
    ratio, interval = None, None
    if choice.by == "timing" and chosen.timing is not None:
        ratio = round(chosen.timing.ratio, 4)
        low, high = chosen.timing.ratio_ci
        interval = (round(low, 4), round(high, 4))
    elif choice.by == "records" and (found := chosen.recorded) is not None and not found.contest:
        ratio, interval = found.record.ratio, found.record.ratio_ci
    elif choice.by == "llvm-mca" and baseline.modelled is not None:
        ratio = round(_cycles(chosen) / _cycles(baseline), 4)
    assert chosen.verdict is not None
    return Selected(
        question=str(variant.question),
        recipe=str(variant.recipe),
        chosen_by=choice.by,
        measured_on=choice.measured_on,
        evidence=choice.evidence,
        ratio_to_baseline=ratio,
        ratio_ci=interval,
        **found_errors(chosen.verdict),
        search=choice.sought or "",
        error_against="euler" if variant.stepper.family == "fixed" else "exact",
        ties=sorted(name for name in choice.ties if name != chosen.name),
    )
