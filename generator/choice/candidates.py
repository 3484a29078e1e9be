"""Which variants the main job tries. The whole registry is for `./gen sweep`.

What is worth trying an impact says: `CANDIDATES` of its module `candidates`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from ..impacts.impact import Impact
from ..impacts.scene import BaseScene
from ..registry.axes import axis
from ..registry.lane_numbers import float_lanes
from ..registry.lanes import widths_of
from ..registry.names import name_of
from ..registry.question import DEFAULT_IMPACT, Contest, Goal, Question
from ..registry.recipe import FIXED, SERIES
from ..registry.roots import COARSEST_FIRST, allows
from ..registry.rules import broken_rule
from ..registry.variant import Variant, answered
from ..targets.target import Target, target_or_port

Options = Mapping[str, str]
BASELINE_STEPS = 1000


@dataclass(frozen=True)
class Candidates:
    """What is known of an impact's kernels before any has been timed."""

    published: Mapping[str, Options]  # by name, tried with the compiler that they name
    baseline: str  # of them, what all are timed against
    fixed: tuple[Options, ...]  # of fixed steps, tried with every compiler
    fixed_default: Options
    fixed_lanes: tuple[tuple[str, str], ...]  # finished lanes and vectors in turn; none: no lanes
    tableaus_for: Callable[[float], tuple[str, ...]]  # that are worth trying for a budget


def candidates_of(impact: Impact) -> Candidates:
    candidates: Candidates = impact.part("candidates").CANDIDATES
    return candidates


def contest_for(
    target: Target, scene: str, model: str, goal: Goal, impact: str = DEFAULT_IMPACT
) -> Contest:
    """That of single calls."""
    return Contest(impact, target.name, scene, model, goal, "scalar")


def _answered(contest: Contest, stepper: str, options: Options) -> Variant:
    asked = contest
    question = Question(asked.impact, asked.target, asked.scene, asked.model, asked.goal)
    return answered(question, stepper, options)


def published(contest: Contest) -> dict[str, Variant]:
    """What others published as variants, by name, those illegal on a target included."""
    rows = candidates_of(contest.row).published
    return {name: _answered(contest, FIXED, options) for name, options in rows.items()}


def published_name(variant: Variant) -> str:
    """Its name among what others published, whichever compiler makes it, or empty."""
    if variant.stepper.family != "fixed" or variant.width > 1:
        return ""
    for name, options in candidates_of(variant.question.row).published.items():
        same = {**options, "compiler": variant["compiler"]}
        if not target_or_port(variant.target).has("fma"):
            same["fma"] = "nofma"
        if answered(variant.question, FIXED, same).options == variant.options:
            return name
    return ""


def singles_for(
    contest: Contest, compilers: Iterable[str], reproducible: bool = False
) -> list[Variant]:
    """Legal variants of single calls in a fixed order: of fixed steps, or for a budget."""
    if contest.goal.budget is not None:
        return exact_candidates(contest, compilers, reproducible)
    return fixed_step_candidates(contest, compilers)


def fixed_step_candidates(contest: Contest, compilers: Iterable[str]) -> list[Variant]:
    """Legal variants of the fixed-step scheme in a fixed order, the baseline first."""
    target = target_or_port(contest.target)
    found = list(published(contest).values())
    if not target.has("fma"):
        found = [v.with_options(fma="nofma") for v in found]
    fma = "fma" if target.has("fma") else "nofma"
    codes = tuple(compilers)
    if "gcc" not in codes:
        found = [v.with_options(compiler=codes[0]) for v in found]
    for compiler in codes:
        found += [
            _answered(contest, FIXED, {"compiler": compiler, "fma": fma, **options})
            for options in candidates_of(contest.row).fixed
        ]
    legal = {name_of(v): v for v in found if broken_rule(v, target) is None}
    return list(legal.values())


def exact_candidates(
    contest: Contest, compilers: Iterable[str], reproducible: bool = False
) -> list[Variant]:
    """Legal variants of the exact steppers for a budget, in a fixed order.

    `reproducible`: those whose bits are the same on every CPU, and no others. A scene with a closed
    form, which no tableau and no root enters, is tried once.
    """
    target, budget = target_or_port(contest.target), contest.goal.budget or 0.0
    fma = "fma" if target.has("fma") else "nofma"
    closed = bool(contest.known_scene.closed_form)
    tableaus = candidates_of(contest.row).tableaus_for(budget)
    found = [
        _answered(contest, tableau, {"compiler": compiler, "fma": fma, **root})
        for compiler in compilers
        for tableau in (tableaus[:1] if closed else tableaus)
        for root in _root_options(contest, closed, reproducible)
    ]
    if contest.row.axes is None or "tiers" in contest.row.axes:
        found += [v.with_options(tiers=kind) for kind in ("fixed", "sticking") for v in found]
    return [v for v in found if broken_rule(v, target) is None]


def _root_options(contest: Contest, closed: bool, reproducible: bool) -> Sequence[Options]:
    axes = contest.row.axes
    if axes is not None and "root" not in axes:
        return ({},)
    codes = ("inv",) if closed else _exact_roots(reproducible)
    return [{"root": code} for code in codes]


def _exact_roots(reproducible: bool) -> tuple[str, ...]:
    return tuple(code for code in axis("root").codes() if (code == "ieee") == reproducible)


def _lane_roots(target: Target, reproducible: bool = False) -> tuple[str, ...]:
    """Roots in lanes of fixed steps that are worth trying, the most accurate last."""
    if reproducible:
        return ("ieee",)
    if not target.has_rsqrt_estimate:
        return ("inv",)
    return ("est2",) if target.has("neon") else ("est1", "cubic")


def default_lanes(single: Variant, target: Target) -> Variant:
    """The same kernel in the widest lanes, with options that are safe before any timing.

    Exact ones in floats where the budget allows.

    Where its scene has none: `single` itself, whose batches go one by one.
    """
    fixed, known = single.stepper.family == "fixed", single.question.known_scene
    ways = candidates_of(single.question.row).fixed_lanes
    widest = max(widths_of(target, known.precision))
    if widest == 1 or (not ways if fixed else known.without_exact_lanes):
        return single
    if not fixed and single.question.row.has_series:
        return (_series_batches(single, target, ()) or [single])[0]
    if not fixed:
        floats, way = float_lanes(single, target), _exact_interleave(known, target)
        root = _exact_lane_roots(single, target, bool(floats))[0]
        numbers, width = ("float", floats[0]) if floats else ("own", widest)
        return single.in_lanes(width, lane_root=root, interleave=way, numbers=numbers)
    finished, interleave = ways[0]
    return single.in_lanes(
        widest, lane_root=_lane_roots(target)[-1], finished=finished, interleave=interleave
    )


def _exact_interleave(scene: BaseScene, target: Target) -> str:
    """Two vectors' stages in turn, where there are stages; not for a page that loads the text."""
    return "i1" if scene.closed_form or target.has("simd128") else "s2"


def batch_candidates(
    single: Variant, target: Target, compilers: Iterable[str], reproducible: bool = False
) -> list[Variant]:
    """Legal variants whose batches go in lanes and whose single calls are as chosen.

    `reproducible`: those whose bits are the same on every CPU.
    """
    if single.stepper.family != "fixed":
        return _exact_batches(single, target, compilers)
    lanes = candidates_of(single.question.row).fixed_lanes
    if not lanes:
        return []
    widest, *narrower = sorted((w for w in widths_of(target) if w > 1), reverse=True)
    roots = _lane_roots(target, reproducible)
    ways = [(widest, root, *way) for root in roots for way in lanes]
    ways += [(width, roots[-1], *lanes[0]) for width in narrower[:1]]
    found = [
        single.in_lanes(
            width, lane_root=root, finished=finished, interleave=interleave, compiler=compiler
        )
        for compiler in compilers
        if compiler != "clangold"
        for width, root, finished, interleave in ways
    ]
    return [v for v in found if broken_rule(v, target) is None]


def _exact_lane_roots(single: Variant, target: Target, floats: bool = False) -> tuple[str, ...]:
    """The coarsest root in lanes that the budget allows, and that of single calls.

    `floats`: where their steps are made in floats.
    """
    plain = single["root"] == "ieee" or bool(single.question.known_scene.closed_form)
    if plain or not target.has_rsqrt_estimate:
        return (single["root"],)
    budget, friction = single.stepper.budget or 0.0, single.question.sensitivity
    enough = (
        code for code in COARSEST_FIRST if allows(budget, friction, code, target, in_floats=floats)
    )
    return tuple(dict.fromkeys((next(enough), single["root"])))


def _exact_batches(single: Variant, target: Target, compilers: Iterable[str]) -> list[Variant]:
    """The chosen exact kernel in the widest lanes, of floats too; narrower ones for comparison."""
    scene = single.question.known_scene
    if scene.without_exact_lanes:
        return []
    if single.question.row.has_series:
        return _series_batches(single, target, compilers)
    there = widths_of(target, scene.precision)
    widest, *narrower = sorted((w for w in there if w > 1), reverse=True)
    roots = _exact_lane_roots(single, target)
    ways = [(widest, root, way, "own") for root in roots for way in ("s2", "i1", "i2")]
    ways += [(width, root, "i2", "own") for root in roots for width in narrower[:1]]
    floats = float_lanes(single, target)
    root = _exact_lane_roots(single, target, floats=True)[0] if floats else ""
    ways += [(width, root, way, "float") for width in floats[:1] for way in ("s2", "i1")]
    ways += [(width, root, "s2", "float") for width in floats[1:2]]
    found = [
        single.in_lanes(
            width, lane_root=root, interleave=interleave, numbers=numbers, compiler=compiler
        )
        for compiler in compilers
        if compiler != "clangold"
        for width, root, interleave, numbers in ways
    ]
    tiered = [v for v in found if v["numbers"] == "float"]
    found += [v.with_options(lane_tiers=kind) for kind in ("fixed", "sticking") for v in tiered]
    return [v for v in found if broken_rule(v, target) is None]


def _series_batches(single: Variant, target: Target, compilers: Iterable[str]) -> list[Variant]:
    """Power series in lanes of doubles, the widest and the next; other steps beside them have none.

    A page loads the text, so WebAssembly has none, either. Without compilers that of single calls.
    """
    if single.stepper.name != SERIES or target.has("simd128"):
        return []
    widths = sorted((w for w in widths_of(target) if w > 1), reverse=True)[:2]
    named = [compiler for compiler in compilers if compiler != "clangold"]
    return [
        single.in_lanes(width, compiler=compiler, **_placed(single))
        for compiler in named or [single["compiler"]]
        for width in widths
    ]


def _placed(single: Variant) -> Options:
    """Where the compiler places products that are added, lanes have none."""
    return {"fma": "fma"} if single["fma"] == "autofma" else {}


def baseline(contest: Contest, compilers: Iterable[str]) -> Variant:
    """What all are timed against, by fixed steps; with FMA where there is any.

    As `paper-initial`: the report's initial C with the report's flags. A scene without
    fixed-step kernels is compared with that of scene `any`.
    """
    codes, target = tuple(compilers), target_or_port(contest.target)
    own = contest.scene if contest.known_scene.fixed_steps else "any"
    wanted = replace(contest, scene=own, goal=Goal(steps=BASELINE_STEPS))
    first = published(wanted)[candidates_of(contest.row).baseline]
    if "gcc" not in codes:
        first = first.with_options(compiler=codes[0])
    return first if target.has("fma") else first.with_options(fma="nofma")


def default_kernel(contest: Contest) -> Variant:
    """What is used before anything was timed."""
    target, known = target_or_port(contest.target), candidates_of(contest.row)
    fma = {"fma": "fma" if target.has("fma") else "nofma"}
    if contest.goal.budget is None:
        return _answered(contest, FIXED, {**known.fixed_default, **fma})
    [root, *_] = _root_options(contest, closed=True, reproducible=False)
    return _answered(contest, known.tableaus_for(contest.goal.budget)[0], {**fma, **root})
