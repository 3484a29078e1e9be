"""Cycles of a kernel's loop on a CPU that need not be here, by llvm-mca."""

from __future__ import annotations

import json
import re
import shutil
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from ..emission.marks import filled, only_where
from ..errors import KernelError
from ..targets.target import Target
from .compilers import Compiler
from .loops import RARE, marked_loops, marked_text
from .loops import Path as LoopPath
from .process import run

ITERATIONS = 100
Region = dict[str, Any]  # of what llvm-mca prints as JSON
_TIMEOUT = 120.0
_MOST_PATHS = 8  # the longest ones are simulated


@dataclass(frozen=True)
class Mca:
    """An llvm-mca that was found."""

    path: str
    version: str
    major: int


@dataclass(frozen=True)
class McaReport:
    """Figures for one iteration of the loop, the simulated CPU being `cpu`."""

    cpu: str
    cycles_per_iteration: float
    uops: float
    throughput_bound: float  # cycles if nothing waited for a result (block rthroughput)
    ipc: float
    dispatch: int  # micro-operations the CPU can dispatch a cycle
    bottleneck: str
    pressure: tuple[tuple[str, float], ...]  # cycles that each unit is busy, the busiest first
    path_cycles: tuple[float, ...]  # of each path simulated; the first is the one reported
    note: str  # what was taken: loops, paths, copies


@cache
def find_mca() -> Mca | None:
    """The newest llvm-mca, or None."""
    found = []
    for suffix in [f"-{major}" for major in range(29, 8, -1)] + [""]:
        if (path := shutil.which("llvm-mca" + suffix)) is None:
            continue
        told = run([path, "--version"], 20.0)
        line = re.search(r".*LLVM version (\d+)\S*", told.output)
        if told.code == 0 and line is not None:
            found.append(Mca(path, line[0].strip(), int(line[1])))
    return max(found, key=lambda m: m.major, default=None)


def require_mca() -> Mca:
    """As find_mca. Raises KernelError that says how to get it."""
    if (mca := find_mca()) is None:
        raise KernelError("no llvm-mca found (apt-get install llvm-19)")
    return mca


def with_regions(marked: str) -> str:
    """A kernel's marked text with the regions of llvm-mca and the blocks that hardly ever run."""

    def line_for(name: str, region: str = "", *condition: str) -> str:
        if name == "rare":
            return f'__asm__ volatile("# {RARE}");'
        if name == "declare":
            return " ".join((region, *condition))
        if name not in ("begin", "end") or region == "step":
            return ""
        statement = f'__asm__ volatile("# LLVM-MCA-{name.upper()} {region}");'
        return only_where(condition, statement)

    return filled(marked, line_for)


def assembly_of(
    sources: Mapping[str, str],
    include_dirs: Iterable[Path],
    compiler: Compiler,
    flags: Iterable[str],
    label: str = "kernel",
) -> str:
    """The assembly text of sources."""
    with tempfile.TemporaryDirectory(prefix="carom-mca-") as scratch:
        folder = Path(scratch)
        for name, text in sources.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
        includes = [f"-I{path.resolve()}" for path in include_dirs]
        texts = []
        for name in (n for n in sources if n.endswith((".cpp", ".cc", ".cxx"))):
            options = [*flags, "-I.", *includes, "-S", name, "-o", "out.s"]
            done = run([compiler.path, *options], _TIMEOUT, cwd=folder)
            if done.code != 0:
                raise KernelError(f"{label} ({compiler.code}): {done.first_error}")
            texts.append((folder / "out.s").read_text("utf-8"))
    return "\n".join(texts)


def run_mca(mca: Mca, target: Target, options: Sequence[str], text: str) -> str:
    """What llvm-mca prints about assembly text on the target's CPU. Raises KernelError."""
    cpu = target.row.mca_cpu
    command = [mca.path, f"-mtriple={target.row.arch}", f"-mcpu={cpu}", *options, "-"]
    done = run(command, _TIMEOUT, text=text)
    if f"'{cpu}' is not a recognized processor" in done.errors:
        raise KernelError(f"llvm-mca {mca.major} does not know {cpu}: a newer LLVM is needed")
    if done.code != 0:
        raise KernelError(f"llvm-mca {mca.major} for {cpu}: {done.first_error}")
    return done.output


def _simulate(
    mca: Mca, target: Target, paths: list[tuple[str, ...]]
) -> tuple[list[Region], list[str]]:
    """One region a path through llvm-mca: its JSON regions in order, the names of the units."""
    # With # on AArch64 too: llvm-mca takes no region from a comment that begins with //.
    text = "".join(
        f"# LLVM-MCA-BEGIN p{n}\n" + "\n".join(lines) + f"\n# LLVM-MCA-END p{n}\n"
        for n, lines in enumerate(paths)
    )
    options = (f"-iterations={ITERATIONS}", "--json")
    try:
        answer = json.loads(run_mca(mca, target, options, text))
        regions, units = answer["CodeRegions"], answer["TargetInfo"]["Resources"]
    except (ValueError, KeyError):
        raise KernelError(
            f"llvm-mca {mca.major} prints no JSON; LLVM 14 or later is needed"
        ) from None
    if len(regions) != len(paths):
        raise KernelError(f"llvm-mca {mca.major}: {len(regions)} of {len(paths)} paths answered")
    return regions, units


def _pressure(region: Region, units: list[str], copies: int) -> tuple[tuple[str, float], ...]:
    """Cycles an iteration that each unit is busy, the busiest first; idle ones are left out."""
    summary = region["SummaryView"]
    last = summary["Instructions"] // summary["Iterations"]  # the row of sums
    found = []
    for info in region["ResourcePressureView"]["ResourcePressureInfo"]:
        index, usage = info["ResourceIndex"], info["ResourceUsage"]
        if info["InstructionIndex"] == last and usage > 0:
            name = re.sub(r"\W+", "", units[index]) if index < len(units) else str(index)
            found.append((name, usage / copies))
    return tuple(sorted(found, key=lambda unit: (-unit[1], unit[0])))


def _bottleneck(region: Region, pressure: tuple[tuple[str, float], ...], copies: int) -> str:
    summary = region["SummaryView"]
    trips = summary["Iterations"] * copies
    cycles, bound = summary["TotalCycles"] / trips, summary["BlockRThroughput"] / copies
    if cycles > 1.1 * bound:
        return f"waits for results: {cycles:.1f} cycles where the units need {bound:.1f}"
    if not pressure or pressure[0][1] < 0.9 * cycles:
        return f"dispatch: {summary['TotaluOps'] / trips:.0f} micro-operations"
    name, busy = pressure[0]
    return f"unit {name}: busy {busy:.1f} of {cycles:.1f} cycles"


def _candidates(assembly: str, region: str) -> tuple[list[LoopPath], str]:
    """The paths worth simulating, longest first, and a text that says what they are."""
    loops = marked_loops(assembly, region)
    if loops:
        # A remainder or peeled copy beside an unrolled loop has fewer markers than the main one.
        most = max(max(p.iterations for p in loop.paths) for loop in loops)
        main = [loop for loop in loops if any(p.iterations == most for p in loop.paths)]
        different = dict.fromkeys(path for loop in main for path in loop.paths)
        paths = sorted(different, key=lambda path: -len(path.lines))
        some = min(_MOST_PATHS, len(paths))
        note = f"longest of {some} paths" if some > 1 else "the loop"
        note += f" of {len(paths)}" if some < len(paths) else ""
        note += f", {len(main)} loops of this name" if len(main) > 1 else ""
        note += f", unrolled {most} times" if most > 1 else ""
        note += "" if all(loop.complete for loop in main) else ", more paths not followed"
        return paths[:some], note
    texts = marked_text(assembly, region)
    if not texts:
        raise KernelError(
            f"no LLVM-MCA region '{region}' in the assembly; was its text marked (with_regions)?"
        )
    return [LoopPath(max(texts, key=len), 1)], "marked text, which is in no loop"


def analyse(assembly: str, target: Target, region: str = "loop") -> McaReport:
    """Figures of the marked loop on the target's CPU.

    Where branches leave several ways through an iteration, the slowest of the longest ones is
    reported: work that can be skipped counts as done, except in blocks that hold the comment
    CAROM-RARE or that the compiler moved out of the loop's way. Raises KernelError.
    """
    mca = require_mca()
    paths, note = _candidates(assembly, region)
    regions, units = _simulate(mca, target, [path.lines for path in paths])
    cycles = [
        answer["SummaryView"]["TotalCycles"] / ITERATIONS / path.iterations
        for answer, path in zip(regions, paths, strict=True)
    ]
    worst = max(range(len(paths)), key=lambda n: cycles[n])
    summary, per = regions[worst]["SummaryView"], paths[worst].iterations
    others = tuple(c for n, c in enumerate(cycles) if n != worst)
    pressure = _pressure(regions[worst], units, per)
    return McaReport(
        cpu=target.row.mca_cpu,
        cycles_per_iteration=cycles[worst],
        uops=summary["TotaluOps"] / ITERATIONS / per,
        throughput_bound=summary["BlockRThroughput"] / per,
        ipc=summary["IPC"],
        dispatch=summary["DispatchWidth"],
        bottleneck=_bottleneck(regions[worst], pressure, per),
        pressure=pressure,
        path_cycles=(cycles[worst], *others),
        note=f"{note}; {mca.version}",
    )
