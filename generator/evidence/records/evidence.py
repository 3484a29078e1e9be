"""What the records of a CPU say of kernels: which record tells most of each, and who won where."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ...errors import InputError
from ...impacts.ball_ball.scene import find_scene
from ...registry.axes import axis
from ...registry.variant import Variant
from ...targets.target import targets
from .files import FOLDER, SUFFIX, read_records
from .recipe import contest_of, recipe_of, variant_of_recipe
from .record import Basis, TimingRecord

NEGLIGIBLE = 1.01  # what takes no more than this of the fastest may be chosen
_NOT_CHOSEN = ("flags=", "fma=autofma")  # in a recipe: a compiler decides how it rounds
WON = 1.02  # what takes no more than this of the fastest has won, too: two timings differ by 1 %

# A recipe as far as it tells of a contest's time; the fields of a contest without its target.
Key = tuple[str, str]


def key_of_kernel(variant: Variant, batch: bool) -> Key:
    """By which a kernel's records are found: options of single calls do not move a batch."""
    recipe = recipe_of(variant)
    if batch and variant.width > 1:
        family = variant.stepper.family
        words = recipe.split(" ")
        kept = [w for w in words if "=" not in w or not _single_only(w.split("=")[0], family)]
        recipe = " ".join(kept)
    return contest_of(variant, batch).split("/", 1)[1], recipe


def _single_only(key: str, family: str) -> bool:
    known = axis(key)
    return known.family == family and not known.lanes


@dataclass(frozen=True)
class Found:
    """The record that tells most of a kernel."""

    record: TimingRecord
    changed: tuple[str, ...]  # what is another since, in a reader's words; empty: nothing
    contest: str = ""  # of the record, where it is not the kernel's own


@dataclass(frozen=True)
class Timings:
    """Records of CPUs by the kernel's key. `damaged`: a line for each record that was skipped."""

    by_cpu: Mapping[str, Mapping[Key, tuple[TimingRecord, ...]]] = field(default_factory=dict)
    damaged: tuple[str, ...] = ()

    def contests(self, cpu: str) -> list[str]:
        return sorted({name for name, _ in self.by_cpu.get(cpu, {})})

    def contest(self, cpu: str, contest: str) -> dict[str, TimingRecord]:
        """The record that tells most of each recipe that may be chosen, the fastest first.

        `contest`: without its target.
        """
        found = {
            recipe: min(records, key=lambda r: (r.spread, r.line()))
            for (name, recipe), records in self.by_cpu.get(cpu, {}).items()
            if name == contest and not any(each in recipe for each in _NOT_CHOSEN)
        }
        return dict(sorted(found.items(), key=lambda each: (each[1].ratio, each[0])))

    def nearest(self, cpu: str, contest: str) -> str:
        """The contest itself, else one of another scene or contact model; empty: there is none.

        The same recipe makes nearly the same loop for each of them.
        """
        there = self.contests(cpu)
        if contest in there:
            return contest
        scene, model, *question = contest.split("/")
        level = find_scene(scene).level
        others = [
            (other_model == model, len(self.contest(cpu, name)), name)
            for name in there
            for other_scene, other_model, *other in [name.split("/")]
            if other == question and find_scene(other_scene).level == level
        ]
        return max(others)[2] if others else ""

    def find(self, cpu: str, variant: Variant, batch: bool, now: Basis) -> Found | None:
        """The record of today's code if there is one, else of earlier code; then the narrowest.

        Of the nearest contest, where the kernel's own was not timed on that CPU at all.
        """
        own, recipe = key_of_kernel(variant, batch)
        contest = self.nearest(cpu, own)
        records = self.by_cpu.get(cpu, {}).get((contest, recipe), ())
        other = contest if contest != own else ""
        found = [Found(r, () if other else r.basis.changed(now), other) for r in records]
        return min(found, key=_telling, default=None)

    def fastest(self, contest: str, target: str, most: int) -> list[Variant]:
        """Kernels of a target's fastest recipes, for any scene or contact model of the contest."""
        found = self.contest(target, self.nearest(target, contest))
        return [variant_of_recipe(f"{target}/{contest}", recipe) for recipe in list(found)[:most]]

    def winners(self, cpu: str, contest: str) -> list[str]:
        """Recipes within 2 % of the fastest, the fastest first."""
        ratios = {recipe: record.ratio for recipe, record in self.contest(cpu, contest).items()}
        return [r for r, ratio in ratios.items() if ratio <= WON * min(ratios.values())]

    def wins(self, variant: Variant, batch: bool) -> int:
        """On how many CPUs a kernel's recipe has won."""
        contest, recipe = key_of_kernel(variant, batch)
        return sum(recipe in self.winners(cpu, self.nearest(cpu, contest)) for cpu in self.by_cpu)


def _telling(found: Found) -> tuple[bool, float, str]:
    return bool(found.changed), found.record.spread, found.record.line()


def timings_of(records: Iterable[TimingRecord], damaged: Sequence[str] = ()) -> Timings:
    """Records by CPU and kernel. One whose recipe the registry no longer has is named, too."""
    by_cpu: dict[str, dict[Key, tuple[TimingRecord, ...]]] = {}
    lost = list(damaged)
    for record in records:
        try:
            variant = variant_of_recipe(record.contest, record.recipe)
        except ValueError as error:
            lost.append(f"{record.contest} {record.recipe}: {error}; the record is skipped")
            continue
        key = key_of_kernel(variant, record.contest.endswith("/batch"))
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
    if other := found[0].contest:
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
