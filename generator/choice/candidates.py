"""Which variants the main job tries. The whole registry is for `./gen sweep`."""

from __future__ import annotations

from collections.abc import Iterable

from ..impacts.ball_ball.scene import Scene, find_scene
from ..registry.axes import axis
from ..registry.lane_numbers import float_lanes
from ..registry.lanes import widths_of
from ..registry.names import name_of
from ..registry.presets import PAPER_PRESETS
from ..registry.roots import COARSEST_FIRST, allows
from ..registry.rules import broken_rule
from ..registry.variant import Stepper, Variant, fixed_steps, make_variant
from ..steppers.exact.budgets import tableaus_for
from ..targets.target import Target

# Our short list for fixed steps: the slips alone and one pressed ball, in the ways of making 1/|c|
# and of writing the loop that have won somewhere.
_BASE = {"state": "reduced", "reuse": "factored", "roots": "early", "branch": "chosen"}
_SHORT_LIST: tuple[dict[str, str], ...] = (
    *(
        {**_BASE, "rsqrt": rsqrt, "order": "chain", "loop": loop}
        for rsqrt in ("ahead", "prev", "est1", "est2", "inv")
        for loop in ("onestage", "twostage")
    ),
    {**_BASE, "rsqrt": "ahead", "loop": "twostage"},
    {**_BASE, "rsqrt": "ahead", "loop": "twostage", "order": "chain", "store": "blocks"},
    {**_BASE, "rsqrt": "ahead", "loop": "twostage", "order": "chain", "simd": "prepost"},
    {**_BASE, "rsqrt": "ahead", "loop": "twostage", "order": "chain", "reuse": "precompute"},
    {**_BASE, "rsqrt": "est1", "loop": "twostage", "reuse": "precompute", "simd": "slips"},
)

# Ways with finished lanes and vectors interleaved that have won somewhere.
_LANES = (("aside", "i3"), ("aside", "i2"), ("refilled", "i3"))


def paper_rows(target: str, scene: str, model: str, stepper: Stepper) -> dict[str, Variant]:
    """The report's rows as variants, by preset name, those illegal on a target included."""
    return {p.name: make_variant(target, scene, model, stepper, **p.options) for p in PAPER_PRESETS}


def fixed_step_candidates(
    target: Target, scene: str, model: str, steps: int, compilers: Iterable[str]
) -> list[Variant]:
    """Legal variants of the fixed-step scheme in a fixed order, the baseline first."""
    stepper = fixed_steps(steps)
    found = list(paper_rows(target.name, scene, model, stepper).values())
    if not target.has("fma"):
        found = [v.with_options(fma="nofma") for v in found]
    fma = "fma" if target.has("fma") else "nofma"
    codes = tuple(compilers)
    if "gcc" not in codes:
        found = [v.with_options(compiler=codes[0]) for v in found]
    for compiler in codes:
        found += [
            make_variant(
                target.name, scene, model, stepper, compiler=compiler, **{"fma": fma, **options}
            )
            for options in _SHORT_LIST
        ]
    legal = {name_of(v): v for v in found if broken_rule(v, target) is None}
    return list(legal.values())


def exact_candidates(
    target: Target,
    scene: str,
    model: str,
    budget: float,
    compilers: Iterable[str],
    reproducible: bool = False,
) -> list[Variant]:
    """Legal variants of the exact steppers for a budget, in a fixed order.

    `reproducible`: those whose bits are the same on every CPU, and no others. A level scene has a
    closed form, which no tableau and no root enters: it is tried once.
    """
    fma = "fma" if target.has("fma") else "nofma"
    closed = find_scene(scene).level
    tableaus = tableaus_for(budget)[:1] if closed else tableaus_for(budget)
    roots = ("inv",) if closed else _exact_roots(reproducible)
    found = [
        make_variant(
            target.name,
            scene,
            model,
            Stepper(tableau, budget=budget),
            compiler=compiler,
            fma=fma,
            root=root,
        )
        for compiler in compilers
        for tableau in tableaus
        for root in roots
    ]
    return [v for v in found if broken_rule(v, target) is None]


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
    fixed, known = single.stepper.family == "fixed", find_scene(single.scene)
    widest = max(widths_of(target, known.precision))
    if widest == 1 or (known.without_exact_lanes and not fixed):
        return single
    if not fixed:
        floats, way = float_lanes(single, target), _exact_interleave(known, target)
        root = _exact_lane_roots(single, target, bool(floats))[0]
        numbers, width = ("float", floats[0]) if floats else ("own", widest)
        return single.in_lanes(width, lane_root=root, interleave=way, numbers=numbers)
    finished, interleave = _LANES[0]
    return single.in_lanes(
        widest, lane_root=_lane_roots(target)[-1], finished=finished, interleave=interleave
    )


def _exact_interleave(scene: Scene, target: Target) -> str:
    """Two vectors' stages in turn, where there are stages; not for a page that loads the text."""
    return "i1" if scene.level or target.has("simd128") else "s2"


def batch_candidates(
    single: Variant, target: Target, compilers: Iterable[str], reproducible: bool = False
) -> list[Variant]:
    """Legal variants whose batches go in lanes and whose single calls are as chosen.

    `reproducible`: those whose bits are the same on every CPU.
    """
    if single.stepper.family != "fixed":
        return _exact_batches(single, target, compilers)
    widest, *narrower = sorted((w for w in widths_of(target) if w > 1), reverse=True)
    roots = _lane_roots(target, reproducible)
    ways = [(widest, root, *way) for root in roots for way in _LANES]
    ways += [(width, roots[-1], *_LANES[0]) for width in narrower[:1]]
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
    plain = single["root"] == "ieee" or find_scene(single.scene).level
    if plain or not target.has_rsqrt_estimate:
        return (single["root"],)
    budget, friction = single.stepper.budget or 0.0, single.question.sensitivity
    enough = (
        code for code in COARSEST_FIRST if allows(budget, friction, code, target, in_floats=floats)
    )
    return tuple(dict.fromkeys((next(enough), single["root"])))


def _exact_batches(single: Variant, target: Target, compilers: Iterable[str]) -> list[Variant]:
    """The chosen exact kernel in the widest lanes, of floats too; narrower ones for comparison."""
    scene = find_scene(single.scene)
    if scene.without_exact_lanes:
        return []
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
    return [v for v in found if broken_rule(v, target) is None]


def baseline(
    target: Target, scene: str, model: str, steps: int, compilers: Iterable[str]
) -> Variant:
    """`paper-initial`: the report's initial C with the report's flags; FMA where there is any.

    A scene without fixed-step kernels is compared with that of scene `any`.
    """
    codes = tuple(compilers)
    stepper = fixed_steps(steps)
    own = scene if find_scene(scene).fixed_steps else "any"
    first = paper_rows(target.name, own, model, stepper)["paper-initial"]
    if "gcc" not in codes:
        first = first.with_options(compiler=codes[0])
    return first if target.has("fma") else first.with_options(fma="nofma")
