"""Shares and times of the tiers: `.venv/bin/python tools/tiers.py --model MODEL [--lanes N]`

Which tier a case takes is noted by the kernel's own text (marks `tier` of emission/marks.py). Times
are of the kernel without notes, interleaved with the adaptive one and with `paper-initial` in one
process: of all cases, and of those of each tier alone, whose branches are then all guessed. With
`--lanes` the same of batches in lanes of floats, where no closed form is told from one step.
"""

from __future__ import annotations

import argparse
import ctypes
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from generator.choice.cases import TIMING_CASES, TIMING_SEED
from generator.emission.kernel_source import emit
from generator.emission.marks import filled
from generator.evidence.timing.bench_tool import CaseSet
from generator.evidence.timing.plan import PlannedKernel, TimingPlan
from generator.evidence.timing.rounds import Rounds
from generator.evidence.verification.errors import Array
from generator.impacts.ball_ball.evidence import EVIDENCE
from generator.impacts.ball_ball.presets import find_preset
from generator.registry.variant import Variant, make_variant
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.build import build_library
from generator.toolchain.flags import compile_flags
from tests.support.exact_kernels import built, exact_variant
from tests.support.kernels import CACHE, EULER, bench_tool, compiler_of

NONE = "none"  # refused, or in closed form
LEAST = 16  # cases that a tier is timed on


@dataclass(frozen=True)
class Row:
    """A tier: its share of the cases, and ns of the kernel and of the adaptive one on them."""

    name: str
    share: float
    ns: float = 0.0
    adaptive: float = 0.0
    ratio: float = 0.0  # of paper-initial, over all cases alone


def noted(variant: Variant) -> ctypes.CDLL:
    """The kernel with a note of the tier that a call takes."""
    source, compiler = emit(variant), compiler_of(variant)
    text = filled(source.marked, _note)
    text = 'extern "C" { extern const char* tier_name; extern int tier_steps; }\n' + text
    own = 'extern "C" { const char* tier_name = ""; int tier_steps = 0; }\n'
    flags = (*compile_flags(variant, compiler, find_target(variant.target)), "-w")
    files = {"carom.h": source.header, "kernel.cpp": text, "note.cpp": own}
    return ctypes.CDLL(str(build_library(files, (), compiler, flags, CACHE, "noted").path))


def _note(name: str, tier: str = "", steps: str = "0", *_rest: str) -> str:
    return f'tier_name = "{tier}"; tier_steps = {steps};' if name == "tier" else ""


def tiers_of(variant: Variant, cases: Array) -> list[str]:
    """The tier of each case."""
    library = noted(variant)
    name = ctypes.c_char_p.in_dll(library, "tier_name")
    steps = ctypes.c_int.in_dll(library, "tier_steps")
    doubles = ctypes.POINTER(ctypes.c_double)
    out, found = np.zeros(18), []
    to = out.ctypes.data_as(doubles)
    to_2 = out[9:].ctypes.data_as(doubles)
    for case in np.ascontiguousarray(cases):
        name.value = NONE.encode()
        steps.value = 0
        given = [case[i:].ctypes.data_as(doubles) for i in (0, 6, 15)]
        library.carom_collide(*given, to, to_2)
        found.append(name.value.decode() + (f" {steps.value}" if steps.value else ""))
    return found


def tiers_in_lanes(variant: Variant, cases: Array) -> list[str]:
    """The tier of each case, in a batch of its own. One step, or none, leaves no note."""
    library = noted(variant)
    name = ctypes.c_char_p.in_dll(library, "tier_name")
    steps = ctypes.c_int.in_dll(library, "tier_steps")
    columns, out, found = np.ascontiguousarray(cases.T), np.zeros((12, 1)), []
    doubles = ctypes.POINTER(ctypes.c_double)
    given, to = (doubles * 18)(), (doubles * 12)(*(row.ctypes.data_as(doubles) for row in out))
    for i, case in enumerate(np.ascontiguousarray(cases)):
        name.value, steps.value = b"whole", 0
        for k in range(18):
            given[k] = columns[6 + k, i:].ctypes.data_as(doubles)
        library.carom_collide_batch(
            case.ctypes.data_as(doubles), None, ctypes.c_size_t(1), given, to, None
        )
        found.append(name.value.decode() + (f" {steps.value}" if steps.value else ""))
    return found


def variants_of(arguments: argparse.Namespace) -> dict[str, Variant]:
    """The kernel with tiers, the same without, and `paper-initial`."""
    target = find_target(arguments.target) if arguments.target else read_host().target
    made = exact_variant(
        arguments.model, arguments.budget, arguments.compiler, arguments.root, target
    )
    options = find_preset("paper-initial").options
    paper = make_variant(target.name, "any", arguments.model, EULER, **options)
    if arguments.lanes > 1:
        ways = {"numbers": "float", "interleave": "s2", "lane_root": "est1"}
        made = made.in_lanes(arguments.lanes, **ways)
        return {
            "tiers": made.with_options(lane_tiers=arguments.tiers),
            "adaptive": made,
            "paper": paper,
        }
    return {
        "tiers": made.with_options(tiers=arguments.tiers),
        "adaptive": made,
        "paper": paper,
    }


def timed(
    libraries: dict[str, PlannedKernel], cases: Array, rounds: int, paper: bool = False
) -> dict[str, float]:
    """ns of each, and under `ratio` that of the tiers over paper-initial."""
    names = [name for name in libraries if paper or name != "paper"]
    kernels = tuple(libraries[name] for name in names)
    plan = TimingPlan(cases, kernels, names[-1], rounds=rounds, seconds=20.0)
    result = Rounds.of([bench_tool().timing_document(plan)])
    found = {name: float(np.median(ns)) for name, ns in result.whole.throughput.ns.items()}
    return {**found, "ratio": result.ratio("tiers", names[-1])[0]}


def rows_of(arguments: argparse.Namespace) -> list[Row]:
    """A row for all cases, then for each tier."""
    variants = variants_of(arguments)
    paths = zip(variants.items(), built(list(variants.values())), strict=True)
    libraries = {name: PlannedKernel(name, path, v.width > 1) for (name, v), path in paths}
    print(variants["tiers"].recipe, variants["tiers"].question.file)
    shared = EVIDENCE.shared if arguments.lanes > 1 else None
    made = bench_tool().make_cases(TIMING_SEED, 4 * TIMING_CASES, fixed=shared)
    cases = chosen_cases(made, arguments.cases)
    tell = tiers_in_lanes if arguments.lanes > 1 else tiers_of
    tiers = np.array(tell(variants["tiers"], cases))
    whole = timed(libraries, cases[:TIMING_CASES], arguments.rounds, paper=True)
    rows = [Row("all", 1.0, whole["tiers"], whole["adaptive"], whole["ratio"])]
    for name in sorted(set(tiers)):
        own = cases[tiers == name]
        if len(own) < LEAST:
            rows.append(Row(name, len(own) / len(cases)))
            continue
        many = np.resize(own, (TIMING_CASES, own.shape[1]))
        ns = timed(libraries, many, arguments.rounds)
        rows.append(Row(name, len(own) / len(cases), ns["tiers"], ns["adaptive"]))
    return rows


def chosen_cases(made: CaseSet, kind: str) -> Array:
    """All, or those kinds that games are made of."""
    easy = np.array([name in EVIDENCE.easy for name in made.kinds])
    return made.rows[easy] if kind == "easy" else made.rows


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--model", default="mathavan2014")
    parser.add_argument("--budget", type=float, default=1e-6)
    parser.add_argument("--cases", choices=("mixed", "easy"), default="mixed")
    parser.add_argument("--target", help="default: this machine's")
    parser.add_argument("--compiler", default="gcc")
    parser.add_argument("--root", default="")
    parser.add_argument("--tiers", choices=("fixed", "sticking"), default="fixed")
    parser.add_argument("--rounds", type=int, default=60)
    parser.add_argument("--lanes", type=int, default=1, help="of floats; default: single calls")
    arguments = parser.parse_args()
    rows = rows_of(arguments)
    print(f"{'tier':12} {'share':>7} {'ns':>7} {'adaptive':>9} {'share * ns':>11}")
    for row in rows:
        print(
            f"{row.name:12} {row.share:7.4f} {row.ns:7.1f} {row.adaptive:9.1f} "
            f"{row.share * row.ns:11.1f}"
        )
    print(f"of paper-initial, all cases: 1/{1 / rows[0].ratio:.1f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
