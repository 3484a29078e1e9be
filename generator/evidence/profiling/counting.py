"""Operations of a kernel, counted by running its text with a number type that counts.

`double` and `float` of the generated text become C++ types whose operators count themselves
(templates/counting). Arithmetic on two constants is left out, as a compiler leaves it out.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...emission.environment import environment
from ...emission.kernel_source import KernelSource
from ...emission.marks import filled, only_where
from ...lowering.counts import OperationCounts
from ...toolchain.build import build_library
from ...toolchain.compilers import Compiler
from ..verification.errors import Array
from .isolated import call_isolated

KINDS = ("add", "mul", "fma", "div", "sqrt", "estimate", "call", "rare")
_APART = ("call", "rare")  # no operations of their own
TIMEOUT = 300.0
_VECTOR = re.compile(r"typedef (double|float) (\w+) __attribute__\(\(vector_size\((\d+)\)\)\);")
_SIZES = {"double": 8, "float": 4}


@dataclass(frozen=True)
class Passages:
    """How often a region was passed with which operations."""

    times: int
    counts: OperationCounts
    calls: int  # of functions of the library, as exp
    rare: int  # blocks with the mark `rare`: guesses that were refused


@dataclass(frozen=True)
class Counted:
    """What a run of a kernel took."""

    cases: int
    collisions: int  # cases with an outcome
    total: OperationCounts
    calls: int
    evaluations: int  # of the rates of the slips; a fixed step has one an iteration
    each: tuple[int, ...]  # evaluations of each case
    regions: Mapping[str, tuple[Passages, ...]]  # most frequent first

    @property
    def per_iteration(self) -> OperationCounts | None:
        """What most passages took in which no guess was refused.

        Of the region `step` where there is one (exact kernels), else of `loop`.
        """
        found = self.regions.get("step") or self.regions.get("loop") or ()
        return next((p.counts for p in found if not p.rare), None)

    @property
    def rare_share(self) -> float:
        """Share of the loop's iterations in which a guess was refused."""
        found = self.regions.get("loop", ())
        return sum(p.times for p in found if p.rare) / max(sum(p.times for p in found), 1)

    @property
    def flops_per_collision(self) -> float:
        return self.total.flops / max(self.collisions, 1)


def instrumented(marked: str) -> str:
    """A kernel's marked text with counters where its regions and evaluations begin and end.

    A closed form has neither: all of its operations count as one.
    """
    return _VECTOR.sub(
        lambda m: f"typedef counted::Lanes<{m[1]}_, {int(m[3]) // _SIZES[m[1]]}> {m[2]};",
        filled(marked, _counter),
    )


def _counter(name: str, region: str = "", *condition: str) -> str:
    """What counts in place of a mark (emission/marks.py)."""
    if name == "declare":
        return " ".join((region, *condition))
    if name in ("begin", "end"):
        return only_where(condition, f'counted::regions.{name}("{region}");')
    return {
        "rare": "++counted::tally.of[counted::k_rare];",
        "evaluation": "++counted::evaluations;",
        "root": "const counted::Apart apart;",
        "tier": "",
        "section": "",
    }[name]


def _evaluation(name: str, *arguments: str) -> str:
    """What counts in place of a mark where evaluations alone are counted."""
    return _counter(name, *arguments) if name in ("declare", "evaluation") else ""


def counting_sources(source: KernelSource, apart: bool, operations: bool = True) -> dict[str, str]:
    """Files of a library with `carom_count`.

    `apart`: roots' own operations are left out; without `operations` there are evaluations alone.
    """
    asked = source.variant.question
    words = asked.row.words()
    values = {
        "abi": asked.row.functions,
        "apart": apart,
        "fields": [(key, words.case_value(key, "row")) for key in asked.known_scene.free],
        "kinds": KINDS,
        "name": source.source_name,
        "width": len(asked.row.columns.case),
    }
    render = {
        name: environment().get_template(f"counting/{template}.j2").render(**values)
        for name, template in (
            ("counted.h", "counted.h" if operations else "uncounted.h"),
            ("count.cpp", "count.cpp"),
        )
    }
    text = instrumented(source.marked) if operations else filled(source.marked, _evaluation)
    # Only count.cpp is compiled: the kernel is included in it.
    kernel = {"carom.h": source.header, "kernel.inc": text}
    return {**kernel, **render}


def count_operations(
    source: KernelSource,
    compiler: Compiler,
    flags: tuple[str, ...],
    cases: Array,
    cache_folder: Path,
    apart: bool = False,
) -> Counted:
    """Run `cases` (rows of the impact's) through a kernel that counts, in a process of its own.

    `apart`: leave out what makes the inverse roots, as the counts in the files of exact kernels do.
    Raises KernelError where the text cannot be counted.
    """
    sources = counting_sources(source, apart)
    library = build_library(sources, (), compiler, (*flags, "-w"), cache_folder, "counting")
    return _counted(call_isolated("carom_count", library.path, cases, TIMEOUT), len(cases))


def count_evaluations(
    source: KernelSource,
    compiler: Compiler,
    flags: tuple[str, ...],
    cases: Array,
    cache_folder: Path,
) -> tuple[int, ...]:
    """Evaluations of the rates that a kernel makes for each case, at a kernel's own speed."""
    sources = counting_sources(source, apart=False, operations=False)
    library = build_library(sources, (), compiler, (*flags, "-w"), cache_folder, "counting")
    counted = _counted(call_isolated("carom_count", library.path, cases, TIMEOUT), len(cases))
    return counted.each


def _counts(values: list[int]) -> OperationCounts:
    known = dict(zip(KINDS, values, strict=True))
    return OperationCounts(**{kind: known[kind] for kind in KINDS if kind not in _APART})


def _counted(document: dict[str, Any], cases: int) -> Counted:
    regions = {
        name: tuple(
            Passages(row[0], _counts(row[1:]), *row[-2:])
            for row in sorted(passages, key=lambda row: -row[0])
        )
        for name, passages in document["regions"].items()
    }
    total = document["total"]
    return Counted(
        cases=cases,
        collisions=document["statuses"][0],
        total=_counts(total),
        calls=total[-2],
        evaluations=document["evaluations"],
        each=tuple(document["each"]),
        regions=regions,
    )
