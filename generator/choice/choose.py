"""The choice: the fastest of what passed; ties go to the fewest options away from the default."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from generator.choice.folder import file_of
from generator.choice.selection import Selected
from generator.choice.workbench import Candidate
from generator.errors import KernelError
from generator.timing.ratios import TimingRun, fastest, ties

MODEL_BAND = 0.005  # modelled cycles that differ by less count as a tie


@dataclass(frozen=True)
class Choice:
    """The kernel that was chosen, those that tie with it, and on what grounds."""

    chosen: Candidate
    ties: tuple[str, ...]
    by: str  # "timing", "llvm-mca" or "default"
    measured_on: str


def _preferred(tied: Sequence[Candidate]) -> Candidate:
    """The first listed of those with the fewest options away from the default."""
    return min(tied, key=lambda c: c.variant.distance_from_default())


def _eligible(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Verified kernels with IEEE arithmetic: -Ofast is for the report's rows alone."""
    found = [
        c
        for c in candidates
        if not c.rejected
        and c.verdict is not None
        and c.verdict.passed
        and c.variant["flags"] == "strict"
    ]
    if not found:
        reasons = "; ".join(sorted({c.rejected for c in candidates if c.rejected})[:3])
        raise KernelError(f"no candidate passed verification: {reasons or 'none was built'}")
    return found


def choose_by_time(candidates: Sequence[Candidate], run: TimingRun, cpu: str) -> Choice:
    """Where the target is this host's CPU."""
    timed = {c.name: c for c in _eligible(candidates) if c.timing is not None}
    best = fastest(run, timed)
    tied = ties(run, best, timed)
    return Choice(_preferred([timed[name] for name in tied]), tied, "timing", cpu)


def choose_by_model(candidates: Sequence[Candidate], cpu: str) -> Choice:
    """Where it is not: by the cycles of a collision that llvm-mca replays."""
    modelled = [c for c in _eligible(candidates) if c.modelled is not None]
    if not modelled:
        raise KernelError("llvm-mca gave no figure for any candidate")
    least = min(_cycles(c) for c in modelled)
    tied = [c for c in modelled if _cycles(c) <= least * (1 + MODEL_BAND)]
    return Choice(_preferred(tied), tuple(c.name for c in tied), "llvm-mca", cpu)


def choose_first(candidates: Sequence[Candidate], cpu: str) -> Choice:
    """Where neither can be had: the first listed of those that hold."""
    chosen = _eligible(candidates)[0]
    return Choice(chosen, (chosen.name,), "default", cpu)


def _cycles(candidate: Candidate) -> float:
    assert candidate.modelled is not None
    return candidate.modelled.cycles


def selected(choice: Choice, baseline: Candidate) -> Selected:
    """The choice as an entry of selection.json."""
    chosen, variant = choice.chosen, choice.chosen.variant
    ratio, interval = None, None
    if choice.by == "timing" and chosen.timing is not None:
        ratio = round(chosen.timing.ratio, 4)
        low, high = chosen.timing.ratio_ci
        interval = (round(low, 4), round(high, 4))
    elif choice.by == "llvm-mca" and baseline.modelled is not None:
        ratio = round(_cycles(chosen) / _cycles(baseline), 4)
    assert chosen.verdict is not None
    return Selected(
        kernel=chosen.name,
        file=file_of(chosen.name),
        model=variant.model,
        stepper=variant.stepper.name,
        steps=variant.stepper.steps,
        budget=variant.stepper.budget,
        width=variant.width,
        chosen_by=choice.by,  # type: ignore[arg-type]
        measured_on=choice.measured_on,
        ratio_to_baseline=ratio,
        ratio_ci=interval,
        max_rel_error=float(f"{chosen.verdict.max_rel_error:.3g}"),
        error_against="euler" if variant.stepper.family == "euler" else "exact",
        ties=sorted(name for name in choice.ties if name != chosen.name),
    )
