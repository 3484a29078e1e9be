"""The registry: names, rules, presets, and that every option does something that holds."""

from __future__ import annotations

import random
import re

import pytest

from generator.emission.kernel_source import emit
from generator.evidence.timing.bench_tool import BenchTool
from generator.impacts.ball_ball.evidence import MODELS
from generator.impacts.ball_ball.presets import PAPER_PRESETS, PRESETS, find_preset
from generator.registry.axes import axes_of, axis
from generator.registry.names import (
    name_of,
    question_named,
    source_name_of,
    variant_named,
    variant_of,
)
from generator.registry.roots import EXACT_ROOTS
from generator.registry.rules import RULES, broken_rule, require_legal
from generator.registry.variant import Stepper, Variant, fixed_steps, make_variant
from generator.targets.target import find_target, targets
from generator.toolchain.flags import compile_flags
from tests.support.kernels import (
    EULER,
    Cases,
    bench_tool,
    build_all,
    expected_cases,
    failures,
    is_legal,
    neighbours,
    random_variants,
    variant,
)

TARGETS = ("x86-64-v2", "x86-64-v3")
ROOTS = axis("root").codes()
# Cycles in "What the report did"; None: a row that the report describes without a figure.
REPORT_ROWS = {
    "paper-initial": 46175,
    "paper-precompute": 46787,
    "paper-fma": 51066,
    "paper-masks": 53472,
    "paper-simd": 64760,
    "paper-simd-rewritten": 46533,
    "paper-prepost": None,
    "paper-less-roots": None,
    "paper-best": 33240,
    "paper-best-twostage": 33739,
}


@pytest.fixture(scope="module")
def tool() -> BenchTool:
    return bench_tool()


@pytest.fixture(scope="module")
def cases(tool: BenchTool) -> Cases:
    return expected_cases(tool, 13, 2000)


def body(each: Variant) -> str:
    """The code of a variant: its text without comments and its own name."""
    text = emit(each).source.replace(source_name_of(each), "NAME")
    text = re.sub(r'return\s+"[^;]*;', "return NAME;", text)
    return "\n".join(line for line in text.splitlines() if not line.lstrip().startswith("//"))


def test_names_are_read_back() -> None:
    rng = random.Random(3)
    for each in random_variants(3, 100, tuple(targets())):
        goal = rng.choice([EULER, fixed_steps(rng.randrange(1, 10**8))])
        made = each.with_stepper(goal)
        lanes = {a.key: rng.choice(a.codes()) for a in axes_of("fixed", 2) if a.lanes}
        wide = made.in_lanes(rng.choice([2, 4, 8]), **lanes)
        assert variant_of(name_of(made)) == made
        assert variant_of(name_of(wide)) == wide
        assert wide.in_lanes(1) == made
    assert len({name_of(v) for v in random_variants(4, 500, TARGETS)}) == 500


def test_a_kernel_is_named_in_full_or_as_its_text_and_its_file_are() -> None:
    wide = make_variant("zen3", "any", "pooltool", Stepper("dp54", budget=1e-6), 8, numbers="float")
    for each in [*random_variants(6, 50, tuple(targets())), wide]:
        source = source_name_of(each)  # what carom_kernel() and Kernel.name tell
        plain = each.with_options(compiler="gcc", flags="strict")
        assert variant_named(name_of(each)) == each
        assert variant_named(source) == plain
        file = f"generated/{each.question.folder}/{each.question.file}"
        for asked in (str(each.question), file, f"/away/{file}"):
            assert question_named(asked, "zen3") == each.question
    native = question_named("generated/ball-ball/native/any/pooltool-e1m06-x8f.cpp", "zen4")
    assert str(native) == "ball-ball/zen4/any/pooltool-e1m06-x8f"


EXACT_X8 = "ball-ball/zen3/any/pooltool-e1m06-x8 dp54"


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda n: n.replace("-n1000-", "-many-"), "no goal"),
        (lambda n: n.replace("-n1000-", "-e1m06-"), "no goal of fixed; expected n<steps>"),
        (lambda n: n.replace(" fixed", " dp54"), "no goal of dp54; expected e<budget>"),
        (lambda n: n.replace(" fixed", " rk4"), "no stepper; there are fixed, .*dp54"),
        (lambda n: n.split(" ")[0], "no stepper"),
        (lambda n: n.replace("-x1 ", "-1 "), "no width"),
        (lambda n: n.replace("-x1 ", "-x8f "), "'x8f' is no width of fixed; expected x8"),
        (lambda n: f"{n} branch=nasty", "no value 'nasty'"),
        (lambda n: f"{n} loop=twostage loop=twostage", "each axis once"),
        (lambda n: f"{n} twostage", "expected AXIS=CODE"),
        (lambda n: f"{n} lane_root=inv", "no option 'lane_root'; it has state, .*flags"),
        (
            lambda n: "ball-ball/zen3/any/pooltool-e1m06-x8 dp54 numbers=float",
            "no option 'numbers'",
        ),
        (lambda n: re.sub("/[^/]*/any/", "/zen9/any/", n), "no such target"),
        (lambda n: n.replace("ball-ball/", "ball-cue/"), "no such impact; there are ball-ball"),
        (lambda n: "one/two", "no question; expected IMPACT/TARGET"),
    ],
)
def test_wrong_names_are_refused(change, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        variant_of(change(name_of(variant())))


def test_every_rule_can_be_broken_alone_of_what_comes_before() -> None:
    """A rule that nothing reaches is dead: each must be the reason for some refusal."""
    rng, met = random.Random(5), set()
    budgets = {"ss43": 1e-3, "dp54": 1e-6, "dop853": 1e-9}
    exact = [Stepper(name, budget=budget) for name, budget in budgets.items()]
    steppers = (*[EULER] * 8, *exact, Stepper("series", budget=1e-6))
    # No target of the registry lacks an estimate; the rule is for one that will.
    unmet = {"estimate-needs-hardware", "lane-estimate-needs-hardware"}
    unmet |= {"lanes-of-series-alone"}  # of another impact; tests/kernels/test_cushion_lanes.py
    wanted = {r.name for r in RULES} - unmet
    for _ in range(60000):
        if wanted <= met:
            break
        target, width = find_target(rng.choice(TARGETS)), rng.choice((1, 1, 1, 2, 8))
        stepper = rng.choice(steppers)
        options = {a.key: rng.choice(a.codes()) for a in axes_of(stepper.family, width)}
        scene = rng.choice(("any", "any", "arcade"))  # of doubles, of floats
        model = rng.choice(("pooltool", "mathavan2014"))  # fixed steps first are of the second
        drawn = make_variant(target.name, scene, model, stepper, width, **options)
        rule = broken_rule(drawn, target)
        if rule is not None:
            met.add(rule.name)
    assert wanted <= met, f"nothing meets {sorted(wanted - met)}"


@pytest.mark.parametrize(
    ("target", "scene", "model", "budget", "fine"),
    [
        ("x86-64-v3", "any", "mathavan2014", 1e-6, {"est1", "cubic", "est2", *EXACT_ROOTS}),
        ("x86-64-v3", "any", "pooltool", 1e-6, {"cubic", "est2", *EXACT_ROOTS}),  # 148 times 2e-7
        ("x86-64-v4", "any", "pooltool", 1e-6, {"est1", "cubic", "est2", *EXACT_ROOTS}),
        ("x86-64-v4", "any", "pooltool", 1e-7, {"cubic", "est2", *EXACT_ROOTS}),
        ("x86-64-v4", "any", "mathavan2014", 1e-3, {"est0", "est1", "cubic", "est2", *EXACT_ROOTS}),
        (
            "x86-64-v4",
            "arcade",
            "mathavan2014",
            1e-3,
            {"est1", "cubic", "est2", *EXACT_ROOTS},
        ),  # by SSE
        (
            "x86-64-v4",
            "stun",
            "mathavan2014",
            1e-9,
            {"est0", "est1", "cubic", "est2", *EXACT_ROOTS},
        ),
    ],
)
def test_roots_are_as_fine_as_budget_and_model_ask(
    target: str, scene: str, model: str, budget: float, fine: set[str]
) -> None:
    """In single calls and in lanes; what grows with a driven table slip must be finer."""
    stepper = Stepper("ss43" if budget == 1e-3 else "dp54", budget=budget)
    base = make_variant(target, scene, model, stepper, 1, root="inv")
    rules = {code: broken_rule(base.with_options(root=code), find_target(target)) for code in ROOTS}
    print({code: rule and rule.name for code, rule in rules.items()})
    assert {code for code, rule in rules.items() if rule is None} == fine
    assert {rule.name for rule in rules.values() if rule} <= {"roots-within-budget"}
    if scene == "any":
        lanes = base.in_lanes(2)
        for code in ROOTS:
            broken = broken_rule(lanes.with_options(lane_root=code), find_target(target))
            assert (broken is None) == (code in fine), code


def test_a_refusal_names_the_rule_and_the_reason() -> None:
    with pytest.raises(ValueError, match=r"illegal combination \(fma-needs-hardware\): the target"):
        require_legal(variant("x86-64-v2", fma="fma"), find_target("x86-64-v2"))


def test_every_row_of_the_report_is_a_preset() -> None:
    assert {p.name: p.report_cycles for p in PAPER_PRESETS} == REPORT_ROWS
    assert find_preset("paper-initial").options == {
        "compiler": "gcc",
        "flags": "report",
        "fma": "autofma",
    }


def test_presets_compile_and_verify_for_all_models(tool: BenchTool, cases: Cases) -> None:
    made = [variant(model=m, **p.options) for m in MODELS for p in PRESETS]
    assert all(is_legal(v) for v in made)
    assert failures(tool, made, cases) == []


def test_presets_are_different_kernels() -> None:
    texts = {(body(v), v["flags"]) for v in (variant(**p.options) for p in PRESETS)}
    assert len(texts) == len(PRESETS)


def test_every_choice_changes_the_text_or_the_flags() -> None:
    """One option away from a legal variant is another kernel, wherever the two are both legal."""
    names = ("paper-masks", "paper-simd-rewritten", "reduced-ahead", "reduced")
    bases = [variant(), *(variant(**find_preset(name).options) for name in names)]
    bases.append(bases[-1].with_options(simd="slips"))
    seen: set[tuple[str, str]] = set()
    texts: dict[str, str] = {}
    for base in bases:
        for other in neighbours(base):
            changed = next(k for k, code in other.options if code != base[k])
            if changed in ("compiler", "flags") or not is_legal(other):
                continue
            for each in (base, other):
                if name_of(each) not in texts:
                    texts[name_of(each)] = body(each)
            assert texts[name_of(base)] != texts[name_of(other)], (name_of(base), changed)
            seen |= {(changed, base[changed]), (changed, other[changed])}
    every = {(a.key, code) for a in axes_of("fixed") for code in a.codes()}
    alone = {(k, c) for k, c in every - seen if k not in ("compiler", "flags")}
    reached = {choice for base in bases for choice in base.options}
    print("legal only together with others:", sorted(alone))
    assert alone <= reached | {("simd", "slips"), ("simd", "balls")}


def test_every_choice_of_lanes_changes_the_text() -> None:
    steps = variant("x86-64-v4", fma="fma", **_scalar_part()).in_lanes(8)
    exact = Stepper("dp54", budget=1e-6)
    exactly = make_variant("x86-64-v4", "any", "mathavan2014", exact, 8, fma="fma", root="est1")
    for base in (steps, exactly):
        lanes = [a for a in axes_of(base.stepper.family, 8) if a.lanes]
        made = [base.with_options(**{a.key: code}) for a in lanes for code in a.codes()[1:]]
        legal = [v for v in made if is_legal(v)]
        print(base.stepper.family, "illegal:", [name_of(v) for v in made if v not in legal])
        # est0, and s2 of fixed steps; i2 to i4 of exact ones would not fit the stack, and both
        # kinds of fixed steps before adaptive ones are of lanes of floats
        assert len(made) - len(legal) == (2 if base is steps else 6)
        assert len({body(v) for v in (base, *legal)}) == 1 + len(legal)


def _scalar_part() -> dict[str, str]:
    return {k: v for k, v in find_preset("reduced").options.items() if k != "fma"}


def test_flags_follow_the_axis() -> None:
    from generator.toolchain.compilers import find_compilers

    compiler, target = find_compilers()[0], find_target("x86-64-v3")
    strict = compile_flags(variant(), compiler, target)
    report = compile_flags(variant(flags="report"), compiler, target)
    assert "-O3" in strict and "-Ofast" in report
    assert strict[-1] == "-ffp-contract=off"
    assert compile_flags(variant(fma="autofma"), compiler, target)[-1] == "-ffp-contract=fast"


def test_one_option_away_compiles_and_verifies(tool: BenchTool, cases: Cases) -> None:
    bases = (variant(model="mathavan2014"), variant(**find_preset("reduced-ahead").options))
    made = [v for base in bases for v in neighbours(base) if is_legal(v)]
    assert failures(tool, made, cases) == []


def test_random_combinations_compile_and_verify(tool: BenchTool, cases: Cases) -> None:
    made = random_variants(2014, 40, TARGETS)
    assert {v.model for v in made} == set(MODELS)
    assert failures(tool, made, cases) == []


def test_the_scene_pool_compiles() -> None:
    made = [
        make_variant("x86-64-v3", "pool", m, EULER, **find_preset("reduced-ahead").options)
        for m in MODELS
    ]
    assert [b for b in build_all(made) if isinstance(b, Exception)] == []
