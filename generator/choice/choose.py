"""The choice of a contest: by time, else by records of such a CPU, else by llvm-mca."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from ..errors import KernelError
from ..evidence.records.evidence import Found, told
from ..evidence.timing.ratios import Interval, to_digits
from ..evidence.timing.rounds import Rounds
from ..registry.variant import Variant
from ..targets.host import Host
from ..targets.target import Target
from .kernel import Estimated, Rejected, Timed, Verified
from .model_error import MODEL_ERROR, model_band
from .selection import ChosenBy
from .ties import Standing, pick
from .timing import standings_of

DIGITS = 4  # of a ratio, which may be one in thousands
MODEL_BAND = 0.005  # modelled cycles that differ by less count as a tie where no recipe has won
Stage = TypeVar("Stage", bound=Verified)


@dataclass(frozen=True)
class Choice:
    """The kernel that was chosen, those that tie with it, and on what grounds."""

    chosen: Verified
    ties: tuple[str, ...]
    by: ChosenBy
    measured_on: str
    evidence: str  # for readers: which CPU, when, how many; or which model
    ratio: float | None = None  # of time, or of modelled cycles, to the baseline's
    interval: Interval | None = None  # of that ratio, 95 %
    sought: str | None = None  # what a search for errors found of it; None: not searched


def eligible(kernels: Sequence[Stage | Rejected]) -> list[Stage]:
    """Verified kernels that round as they are written: -Ofast is for the report's rows alone."""
    passed = [k for k in kernels if not isinstance(k, Rejected)]
    found = [k for k in passed if k.variant.rounds_as_written]
    if not found:
        reasons = "; ".join(sorted({k.text for k in kernels if isinstance(k, Rejected)})[:3])
        raise KernelError(f"no candidate passed verification: {reasons or 'none was built'}")
    return found


def choose_by_time(kernels: Sequence[Verified | Rejected], rounds: Rounds, host: Host) -> Choice:
    """Where the target is this host's CPU."""
    timed = [k for k in eligible(kernels) if isinstance(k, Timed)]
    _, standings = standings_of(rounds, timed)
    chosen, cpu = _of(timed, pick(standings)), host.target.name
    low, high = chosen.timing.ratio_ci
    return Choice(
        chosen=chosen,
        ties=tuple(s.name for s in standings if s.ties),
        by="timing",
        measured_on=cpu,
        evidence=f"timed on {host.cpu} ({cpu}), {rounds.whole.day}, {len(timed)} kernels",
        ratio=to_digits(chosen.timing.ratio, DIGITS),
        interval=(to_digits(low, DIGITS), to_digits(high, DIGITS)),
    )


def choose_by_model(
    kernels: Sequence[Estimated | Rejected],
    cpu: str,
    wins: Callable[[Variant], int] = lambda _: 0,
    baseline: float | None = None,
) -> Choice:
    """Where it is not: by the cycles of a collision that llvm-mca replays.

    Of those it cannot tell apart the one whose recipe has won on the most CPUs that were timed;
    the fastest where none has. `baseline`: its cycles.
    """
    cycles = _cycles(eligible(kernels))
    if not cycles:
        raise KernelError("llvm-mca gave no figure for any candidate")
    least = min(cycles.values())
    near = [v for v in cycles if cycles[v] <= least * (1 + model_band(v))]
    most = max(wins(v) for v in near)
    tied = near if most else [v for v in near if cycles[v] <= least * (1 + MODEL_BAND)]
    among = [Standing(v, cycles[v] / least, apart=False) for v in tied if wins(v) == most]
    chosen = pick(among, limit=float("inf"))
    evidence = f"modelled by llvm-mca for {cpu}, {len(cycles)} kernels"
    names = tuple(Standing(v, cycles[v] / least).name for v in tied)
    return _modelled(_of(eligible(kernels), chosen), names, cpu, evidence, baseline)


def choose_by_records(
    kernels: Sequence[Estimated | Rejected],
    target: Target,
    lead: Callable[[Variant, Variant], int] = lambda one, other: 0,
    baseline: float | None = None,
) -> Choice:
    """Where the target's CPU was timed elsewhere: records compete among themselves.

    A kernel that nobody timed there takes their winner's place where the model says that it is
    faster by more than the model errs; or faster, and `lead` that it was so on other CPUs which
    timed both. `baseline`: its modelled cycles.
    """
    found = eligible(kernels)
    records = {k.variant: k.record for k in found if k.record is not None}
    least = min(each.record.ratio for each in records.values())
    standings = [Standing(v, each.record.ratio / least) for v, each in records.items()]
    winner = pick(standings)
    cycles = _cycles(found)
    rest = {v: n for v, n in cycles.items() if v not in records}
    evidence = told(list(records.values()), len(rest))
    for variant in sorted(rest, key=lambda v: rest[v]) if winner in cycles else ():
        far = rest[variant] < cycles[winner] / MODEL_ERROR
        if far or (rest[variant] < cycles[winner] and lead(variant, winner) > 0):
            why = "by so much" if far else "on other CPUs too, so"
            evidence += f", one of which is faster {why} that it is chosen"
            better = _of(found, variant)
            return _modelled(better, (better.name,), target.row.mca_cpu, evidence, baseline)
    ratio = _ratio_of(records[winner])
    return Choice(
        chosen=_of(found, winner),
        ties=tuple(s.name for s in standings if s.ties),
        by="records",
        measured_on=target.name,
        evidence=evidence,
        ratio=ratio[0] if ratio else None,
        interval=ratio[1] if ratio else None,
    )


def _ratio_of(found: Found) -> tuple[float, Interval] | None:
    """None where the record is of another contest."""
    return None if found.contest else (found.record.ratio, found.record.ratio_ci)


def _modelled(
    chosen: Estimated, tied: tuple[str, ...], cpu: str, evidence: str, baseline: float | None
) -> Choice:
    own = chosen.model.cycles if chosen.model else None
    ratio = to_digits(own / baseline, DIGITS) if own and baseline else None
    return Choice(chosen, tied, "llvm-mca", cpu, evidence, ratio)


def _cycles(kernels: Sequence[Estimated]) -> dict[Variant, float]:
    return {k.variant: k.model.cycles for k in kernels if k.model is not None}


def _of(kernels: Iterable[Stage], variant: Variant) -> Stage:
    return next(kernel for kernel in kernels if kernel.variant == variant)
