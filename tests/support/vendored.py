"""What tests of vendoring share: folders made without any choice being timed, compilers, runs."""

from __future__ import annotations

import os
import shutil
import subprocess
from functools import cache
from pathlib import Path

from generator.choice import candidates
from generator.choice.selection import Selected
from generator.evidence.timing.bench_tool import BenchTool, build_bench_tool
from generator.places import cache_folder
from generator.registry.lanes import widths_of
from generator.registry.question import Goal
from generator.targets.target import find_target
from generator.vendoring.folder import write_files
from generator.vendoring.job import all_files
from generator.vendoring.kernels import TargetKernels
from generator.vendoring.request import VendorRequest, checked

EXACT = Goal(budget=1e-6)
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")
PAIRS = [  # C++ and C compilers of one make
    pair
    for pair in (("g++", "gcc"), ("clang++", "clang"))
    if all(shutil.which(name) for name in pair)
]


def request_for(targets: str, goal: Goal = EXACT, **options: object) -> VendorRequest:
    """A request with the defaults of the command."""
    given = {"scene": "any", "model": "", **options}
    return checked(VendorRequest(tuple(targets.split(",")), goal=goal, **given))  # type: ignore[arg-type]


def record_for(request: VendorRequest, target: str, width: int = 1) -> Selected:
    """A kernel as if it had been chosen: what stands in a selection, without its hours."""
    goal = request.goal
    asked = (find_target(target), request.scene, request.model, goal, request.impact)
    variant = candidates.default_kernel(candidates.contest_for(*asked))
    # Of fixed steps one Newton step turns too many at the end where estimates are their worst.
    lanes = {"lane_root": "cubic"} if width > 1 and goal.steps is not None else {}
    if request.reproducible:
        lanes = {"lane_root": "ieee"} if width > 1 else {}
        if goal.steps is None:
            variant = variant.with_options(root="ieee")
    variant = variant.in_lanes(width, **lanes)
    return Selected(
        question=str(variant.question),
        recipe=str(variant.recipe),
        chosen_by="default",
        measured_on="none",
        ratio_to_baseline=None,
        ratio_ci=None,
        max_rel_error=None,
        error_against="exact" if goal.steps is None else "euler",
        ties=[],
    )


@cache
def files_for(request: VendorRequest, lanes: bool = False) -> dict[str, str]:
    """All files of a request; made once a process. `lanes`: with a kernel for batches each."""
    chosen = {part.impact: _chosen(part, lanes) for part in request.parts}
    return all_files(request, chosen, tools_for(request))


def tools_for(request: VendorRequest) -> dict[str, BenchTool]:
    """What answers golden cases, of each impact."""
    return {
        part.impact: build_bench_tool(cache_folder(), impact=part.row) for part in request.parts
    }


def _chosen(part: VendorRequest, lanes: bool) -> dict[str, TargetKernels]:
    chosen = {}
    for target in part.targets:
        batch = None
        if lanes and not part.known_scene.without_exact_lanes:
            batch = record_for(part, target, max(widths_of(find_target(target))))
        chosen[target] = TargetKernels(record_for(part, target), batch)
    return chosen


def vendored(folder: Path, request: VendorRequest, lanes: bool = False) -> Path:
    """A vendored folder in a new place."""
    folder.mkdir(parents=True)
    write_files(folder, files_for(request, lanes))
    return folder


def ran(command: list[object], **options: object) -> subprocess.CompletedProcess[str]:
    """A command that must succeed; what it said where it does not."""
    environment = {k: v for k, v in os.environ.items() if not k.endswith("_TARGET")}
    environment |= options.pop("env", {})  # type: ignore[arg-type]
    done = subprocess.run(
        [str(word) for word in command],
        capture_output=True,
        text=True,
        timeout=1500,
        env=environment,
        **options,  # type: ignore[call-overload]
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done


def compiled(folder: Path, into: Path, compiler: str, *flags: str) -> list[Path]:
    """Object files of all units, as a user compiles them."""
    into.mkdir(parents=True, exist_ok=True)
    objects = []
    for source in sorted(folder.glob("*.cpp")):
        objects.append(into / f"{source.stem}.o")
        ran([compiler, "-std=c++17", *STRICT, *flags, "-c", source, "-o", objects[-1]])
    return objects
