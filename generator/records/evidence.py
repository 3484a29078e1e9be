"""What the records of a CPU say of kernels: which record tells most of each, and who won where."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from generator.errors import InputError
from generator.records.files import FOLDER, SUFFIX, read_records
from generator.records.recipe import contest_of, recipe_of, variant_of_recipe
from generator.records.record import Basis, TimingRecord
from generator.targets.target import targets
from generator.variants.axes import axis
from generator.variants.variant import Variant

WON = 1.02  # what takes no more than this of the fastest has won, too

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
    """The record that tells most of a kernel. `changed`: what is another since; empty: nothing."""

    record: TimingRecord
    changed: tuple[str, ...]


@dataclass(frozen=True)
class Timings:
    """Records of CPUs by the kernel's key. `damaged`: a line for each record that was skipped."""

    by_cpu: Mapping[str, Mapping[Key, tuple[TimingRecord, ...]]]
    damaged: tuple[str, ...] = ()

    def find(self, cpu: str, variant: Variant, batch: bool, now: Basis | None) -> Found | None:
        """The record of today's code if there is one, else of earlier code; then the narrowest."""
        records = self.by_cpu.get(cpu, {}).get(key_of_kernel(variant, batch), ())
        found = [Found(record, record.basis.changed(now) if now else ()) for record in records]
        return min(found, key=_telling, default=None)

    def contest(self, cpu: str, contest: str) -> dict[str, TimingRecord]:
        """The record that tells most of each recipe. `contest`: without its target."""
        there = self.by_cpu.get(cpu, {})
        return {
            recipe: min(records, key=lambda r: r.spread)
            for (name, recipe), records in there.items()
            if name == contest
        }

    def contests(self, cpu: str) -> list[str]:
        return sorted({name for name, _ in self.by_cpu.get(cpu, {})})

    def wins(self, variant: Variant, batch: bool) -> int:
        """On how many CPUs a kernel's recipe is within 2 % of the fastest that may be chosen."""
        contest, recipe = key_of_kernel(variant, batch)
        return sum(recipe in self.winners(cpu, contest) for cpu in self.by_cpu)

    def winners(self, cpu: str, contest: str) -> list[str]:
        """Recipes within 2 % of the fastest of a contest that may be chosen, the fastest first."""
        found = self.contest(cpu, contest)
        ratios = {r: record.ratio for r, record in found.items() if "flags=" not in r}
        least = min(ratios.values(), default=0.0)
        return sorted((r for r in ratios if ratios[r] <= WON * least), key=lambda r: ratios[r])


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


def read_timings(root: Path, say: Callable[[str], None] = lambda line: None) -> Timings:
    """All of `timings/`; each line that does not read is said and skipped."""
    records, damaged = [], []
    for path in sorted((root / FOLDER).glob(f"*{SUFFIX}")):
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
