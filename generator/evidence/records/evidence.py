"""What the records of a CPU say of kernels: which record tells most of each, and who won where."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from ...errors import InputError
from ...registry.axes import axis
from ...registry.names import name_of, variant_of
from ...registry.question import Contest
from ...registry.variant import Variant, answered
from ...targets.target import targets
from .files import FOLDER, SUFFIX, read_records
from .record import Basis, TimingRecord

NEGLIGIBLE = 1.01  # what takes no more than this of the fastest may be chosen
WON = 1.02  # what takes no more than this of the fastest has won, too: two timings differ by 1 %

# What a kernel's records are found by: its contest, and the kernel as far as it tells of the time.
Key = tuple[Contest, Variant]


def key_of_kernel(variant: Variant) -> Key:
    """By which a kernel's records are found: options of single calls do not move a batch."""
    asked = replace(variant.question, target="")
    options = dict(variant.options)
    if variant.width > 1:
        options = {key: code for key, code in options.items() if not _single_only(key)}
    return asked.contest, answered(asked, variant.recipe.stepper, options)


def _single_only(key: str) -> bool:
    known = axis(key)
    return known.family != "all" and not known.lanes


@dataclass(frozen=True)
class Found:
    """The record that tells most of a kernel."""

    record: TimingRecord
    changed: tuple[str, ...]  # what is another since, in a reader's words; empty: nothing
    contest: Contest | None = None  # of the record, where it is not the kernel's own


@dataclass(frozen=True)
class Timings:
    """Records of CPUs by the kernel's key. `damaged`: a line for each record that was skipped."""

    by_cpu: Mapping[str, Mapping[Key, tuple[TimingRecord, ...]]] = field(default_factory=dict)
    damaged: tuple[str, ...] = ()

    def contests(self, cpu: str) -> list[Contest]:
        return sorted({contest for contest, _ in self.by_cpu.get(cpu, {})}, key=str)

    def contest(self, cpu: str, contest: Contest) -> dict[Variant, TimingRecord]:
        """The record that tells most of each kernel that may be chosen, the fastest first.

        The kernels are of no target.
        """
        found = {
            kernel: min(records, key=lambda r: (r.spread, r.line()))
            for (name, kernel), records in self.by_cpu.get(cpu, {}).items()
            if name == contest and kernel.rounds_as_written
        }
        return dict(sorted(found.items(), key=lambda each: (each[1].ratio, name_of(each[0]))))

    def nearest(self, cpu: str, contest: Contest) -> Contest | None:
        """The contest itself, else one of another scene or contact model; None: there is none.

        The same recipe makes nearly the same loop for each of them.
        """
        there = self.contests(cpu)
        if contest in there:
            return contest
        closed = bool(contest.known_scene.closed_form)
        others = [
            other
            for other in there
            if replace(other, scene=contest.scene, model=contest.model) == contest
            and bool(other.known_scene.closed_form) == closed
        ]
        return max(
            others,
            key=lambda o: (o.model == contest.model, len(self.contest(cpu, o)), str(o)),
            default=None,
        )

    def find(self, cpu: str, variant: Variant, now: Basis) -> Found | None:
        """The record of today's code if there is one, else of earlier code; then the narrowest.

        Of the nearest contest, where the kernel's own was not timed on that CPU at all.
        """
        own, kernel = key_of_kernel(variant)
        contest = self.nearest(cpu, own)
        if contest is None:
            return None
        records = self.by_cpu.get(cpu, {}).get((contest, _moved(kernel, contest)), ())
        other = contest if contest != own else None
        found = [Found(r, () if other else r.basis.changed(now), other) for r in records]
        return min(found, key=_telling, default=None)

    def fastest(self, contest: Contest, most: int) -> list[Variant]:
        """Kernels of the target's fastest recipes, for any scene or contact model of a contest."""
        cpu = contest.target
        nearest = self.nearest(cpu, contest.everywhere)
        found = self.contest(cpu, nearest) if nearest is not None else {}
        return [_moved(kernel, contest, cpu) for kernel in list(found)[:most]]

    def winners(self, cpu: str, contest: Contest) -> list[Variant]:
        """Kernels within 2 % of the fastest, the fastest first."""
        ratios = {kernel: record.ratio for kernel, record in self.contest(cpu, contest).items()}
        return [each for each, ratio in ratios.items() if ratio <= WON * min(ratios.values())]

    def wins(self, variant: Variant) -> int:
        """On how many CPUs a kernel's recipe has won."""
        own, kernel = key_of_kernel(variant)
        near = {cpu: self.nearest(cpu, own) for cpu in self.by_cpu}
        return sum(
            _moved(kernel, there) in self.winners(cpu, there)
            for cpu, there in near.items()
            if there is not None
        )

    def lead(self, variant: Variant, rival: Variant) -> int:
        """On how many more CPUs a kernel's recipe was the faster of two than the slower.

        CPUs count that have timed both, and where one took over 2 % more than the other.
        """
        return sum(self._ahead(cpu, variant, rival) for cpu in self.by_cpu)

    def _ahead(self, cpu: str, variant: Variant, rival: Variant) -> int:
        there = self.nearest(cpu, key_of_kernel(variant)[0])
        if there is None:
            return 0
        timed = self.contest(cpu, there)
        kernels = [_moved(key_of_kernel(each)[1], there) for each in (variant, rival)]
        if not all(each in timed for each in kernels):
            return 0
        own, other = (timed[each].ratio for each in kernels)
        return int(own * WON < other) - int(other * WON < own)


def _moved(kernel: Variant, contest: Contest, target: str = "") -> Variant:
    """The same kernel for the scene and the contact model of another contest."""
    return kernel.moved(target=target, scene=contest.scene, model=contest.model)


def _telling(found: Found) -> tuple[bool, float, str]:
    return bool(found.changed), found.record.spread, found.record.line()


def timings_of(records: Iterable[TimingRecord], damaged: Sequence[str] = ()) -> Timings:
    """Records by CPU and kernel. One whose recipe the registry no longer has is named, too."""
    by_cpu: dict[str, dict[Key, tuple[TimingRecord, ...]]] = {}
    lost = list(damaged)
    for record in records:
        try:
            key = key_of_kernel(variant_of(record.kernel))
        except ValueError as error:
            lost.append(f"{record.kernel}: {error}; the record is skipped")
            continue
        there = by_cpu.setdefault(record.cpu.target, {})
        there[key] = (*there.get(key, ()), record)
    return Timings(by_cpu, tuple(lost))


def told(found: Sequence[Found], modelled: int = 0) -> str:
    """What a choice by records rests on: the CPU, when, how many, and how many of earlier code."""
    days = sorted({each.record.day for each in found})
    span = days[0] if len(days) == 1 else f"{days[0]} to {days[-1]}"
    text = f"timed on {found[0].record.cpu.text}, {span}, {len(found)} records"
    earlier = [each for each in found if each.changed]
    changes = {change: None for each in earlier for change in each.changed}
    if (other := found[0].contest) is not None:
        text += f" of {other}, as none of these kernels"
    elif earlier:
        text += f", {len(earlier)} of them of earlier code ({', '.join(changes)})"
    return f"{text}; {modelled} more modelled by llvm-mca" if modelled else text


def read_timings(roots: Iterable[Path], say: Callable[[str], None] = lambda line: None) -> Timings:
    """All of `timings/` in these folders; each line that does not read is said and skipped."""
    records: list[TimingRecord] = []
    damaged: list[str] = []
    for path in (path for root in roots for path in sorted((root / FOLDER).glob(f"*{SUFFIX}"))):
        if path.stem not in targets():
            raise InputError(
                f"{path}: no such target; name the file after one of ./gen list targets"
            )
        file = read_records(path)
        records += file.records
        damaged += file.damaged
    found = timings_of(records, damaged)
    for line in found.damaged:
        say(line)
    return found
