"""Batches in lanes: what a collision gives depends on nothing but itself."""

import numpy as np
import pytest

from generator.choice.modelling import lanes_in_flight
from generator.errors import KernelError
from generator.evidence.timing.bench_tool import Way
from generator.evidence.verification.worst_estimates import PATTERNS
from generator.impacts.ball_ball.evidence import MODELS
from generator.impacts.ball_ball.evidence.fixed_steps import euler_verdict
from generator.impacts.ball_ball.evidence.measure import STATUS
from generator.impacts.ball_ball.row import BALL_BALL
from generator.impacts.ball_ball.tiers import has_bound
from generator.registry.roots import allows_floats
from generator.registry.rules import broken_rule
from generator.registry.variant import Stepper, fixed_steps, make_variant
from generator.targets.host import read_host
from generator.targets.target import find_target
from tests.support.batch_calls import PARAMETERS, BatchFunction, inputs_of
from tests.support.exact_kernels import Worst, load_hard
from tests.support.kernels import bench_tool, build_all, expected_cases
from tests.support.reference import load_reference

OK, SEPARATING, BAD_INPUT, TILTED = range(4)
SCALAR = {
    "state": "reduced",
    "reuse": "factored",
    "roots": "early",
    "branch": "chosen",
    "rsqrt": "inv",
}
# target, lanes of a vector, options: every instruction set, every way with finished lanes.
KERNELS = (
    ("x86-64-v2", 2, {"finished": "refilled", "interleave": "i3", "lane_root": "cubic"}),
    ("x86-64-v3", 4, {"finished": "aside", "interleave": "i2", "lane_root": "cubic"}),
    ("x86-64-v4", 4, {"finished": "masked", "interleave": "i1", "lane_root": "inv"}),
    ("x86-64-v4", 8, {"finished": "aside", "interleave": "i3", "lane_root": "est1"}),
    ("x86-64-v4", 8, {"finished": "refilled", "interleave": "i1", "lane_root": "est2"}),
)
IN_FLOATS = {"numbers": "float", "interleave": "s2", "lane_root": "est1"}
FIXED_FIRST = {**IN_FLOATS, "lane_tiers": "fixed"}
TO_STICKING = {**IN_FLOATS, "lane_tiers": "sticking"}
# target, lanes, tableau, budget, options: exact kernels, with the vocabularies that they share.
IN_DOUBLES = (
    ("x86-64-v2", 2, "dp54", 1e-6, {"interleave": "i1", "root": "est1", "fma": "nofma"}),
    ("x86-64-v3", 4, "dp54", 1e-6, {"interleave": "i2", "root": "est1", "fma": "fma"}),
    ("x86-64-v3", 4, "dp54", 1e-6, {"interleave": "s2", "lane_root": "est1", "fma": "fma"}),
    ("x86-64-v4", 8, "dp54", 1e-6, {"interleave": "s2", "root": "est1", "fma": "fma"}),
    ("x86-64-v4", 8, "ss43", 1e-3, {"interleave": "i1", "root": "est0", "fma": "fma"}),
    ("x86-64-v4", 8, "dop853", 1e-9, {"interleave": "s2", "root": "cubic", "fma": "fma"}),
)
# Steps in floats, the caller's arrays and the frame in doubles.
STEPS_IN_FLOATS = (
    ("x86-64-v2", 4, "dp54", 1e-6, {**IN_FLOATS, "lane_root": "cubic", "fma": "nofma"}),
    ("x86-64-v4", 16, "dp54", 1e-6, {**IN_FLOATS, "fma": "fma"}),
    # Fixed steps in front of them, where their certificates are known.
    ("x86-64-v2", 4, "dp54", 1e-6, {**FIXED_FIRST, "lane_root": "cubic", "fma": "nofma"}),
    ("x86-64-v3", 8, "dp54", 1e-6, {**FIXED_FIRST, "interleave": "i1", "fma": "fma"}),
    ("x86-64-v4", 16, "dp54", 1e-6, {**FIXED_FIRST, "fma": "fma"}),
    ("x86-64-v3", 8, "ss43", 1e-3, {**FIXED_FIRST, "fma": "fma"}),
    # And steps to where contact sticks.
    ("x86-64-v2", 4, "dp54", 1e-6, {**TO_STICKING, "lane_root": "cubic", "fma": "nofma"}),
    ("x86-64-v3", 8, "dp54", 1e-6, {**TO_STICKING, "fma": "fma"}),
    ("x86-64-v4", 16, "dp54", 1e-6, {**TO_STICKING, "fma": "fma"}),
)
EXACT = (*IN_DOUBLES, *STEPS_IN_FLOATS)
# The same in scene `arcade`: lanes of float, twice as many.
FLOATS = (
    ("x86-64-v2", 4, "ss43", 1e-3, {"interleave": "i1", "root": "est1", "fma": "nofma"}),
    ("x86-64-v3", 8, "dp54", 1e-4, {"interleave": "i2", "root": "inv", "fma": "fma"}),
    ("x86-64-v4", 16, "ss43", 1e-3, {"interleave": "s2", "lane_root": "est0", "fma": "fma"}),
)
EQUAL_TABLE = (*PARAMETERS[:3], PARAMETERS[2], *PARAMETERS[4:])  # as `arcade` has it


def _variant(target, width, model, steps, options):
    fma = "fma" if find_target(target).has("fma") else "nofma"
    stepper = fixed_steps(steps)
    chosen = {**SCALAR, "fma": fma, **options}
    return make_variant(target, "any", model, stepper, width, **chosen)


def _exact(target, width, model, tableau, budget, options, scene="any"):
    stepper = Stepper(tableau, budget=budget)
    if options.get("lane_tiers") and not has_bound(model, budget):
        options = {**options, "lane_tiers": "adaptive"}
    made = make_variant(target, scene, model, stepper, width, **options)
    if made["numbers"] == "float" and not allows_floats(
        budget, BALL_BALL.sensitivity(model)
    ):  # `pooltool`: from 2.2e-5
        return _exact(target, width, model, tableau, 2.5e-5, options, scene)
    if broken_rule(made, find_target(target)) is None:
        return made
    return made.with_options(root="cubic", lane_root="cubic")  # `pooltool` needs finer ones


def _built(variant):
    if not read_host().runs(find_target(variant.target)):
        pytest.skip(f"{variant.target} code does not run on this CPU")
    library = build_all([variant])[0]
    assert not isinstance(library, KernelError), library
    return library


def _mathavan(kernel):
    """The variant of a row of KERNELS, EXACT or FLOATS."""
    if kernel in KERNELS:
        target, width, options = kernel
        return _variant(target, width, "mathavan2014", 40, options)
    target, width, *rest = kernel
    scene = "arcade" if kernel in FLOATS else "any"
    return _exact(target, width, "mathavan2014", *rest, scene=scene)


def _what(kernel):
    """What tells a row of those tables from others of its target and width."""
    if len(kernel) == 3:
        return kernel[2]["finished"]
    tiers = kernel[4].get("lane_tiers", "")
    return f"{kernel[2]}-{kernel[3]:g}{'-' if tiers else ''}{tiers}"


@pytest.fixture(
    scope="module",
    params=(*KERNELS, *EXACT, *FLOATS),
    ids=lambda k: f"{k[0]}-x{k[1]}-{_what(k)}",
)
def kernel(request):
    """A batch function, and how many lanes it has in flight."""
    variant = _mathavan(request.param)
    library = _built(variant)
    parameters = EQUAL_TABLE if request.param in FLOATS else PARAMETERS
    lanes = lanes_in_flight(variant)
    return BatchFunction(library.path, parameters), lanes


@pytest.fixture(scope="module")
def mixed():
    """Collisions of all kinds, those that stick and hang over among them."""
    return inputs_of(bench_tool().make_cases(4, 400, mixed=False).rows)


def test_outcome_depends_neither_on_neighbours_nor_on_n(kernel, mixed):
    call, lanes = kernel
    whole = call(mixed)
    order = np.random.default_rng(1).permutation(len(mixed))
    shuffled = call(mixed[order])
    back = np.argsort(order)
    assert np.array_equal(shuffled.velocities[back], whole.velocities)
    for n in range(3 * lanes + 2):
        part = call(mixed[:n])
        assert np.array_equal(part.velocities, whole.velocities[:n]), n
        assert np.array_equal(part.status, whole.status[:n]), n
        assert part.good == int((part.status == OK).sum())
    alone = [call(row[None]).velocities[0] for row in mixed]
    assert np.array_equal(np.array(alone), whole.velocities)
    print(f"{len(mixed)} collisions, n = 0 to {3 * lanes + 1}, in two orders and one by one: alike")


def _planted(row):
    """Ways to spoil a collision, and the status that each must get."""
    nan, infinite, coincident, separating, tilted, above = (row.copy() for _ in range(6))
    nan[4] = np.nan
    infinite[12] = np.inf
    coincident[9:12] = coincident[0:3]
    separating[3:6], separating[12:15] = row[12:15], row[3:6]
    tilted[11] += 0.3 * np.hypot(*(row[9:11] - row[0:2]))
    above[9:11] = above[0:2]
    above[11] = above[2] + 0.05
    return (
        (nan, BAD_INPUT),
        (infinite, BAD_INPUT),
        (coincident, BAD_INPUT),
        (separating, SEPARATING),
        (tilted, TILTED),
        (above, TILTED),
    )


def test_what_is_no_collision_disturbs_no_other_lane(kernel, mixed):
    call, lanes = kernel
    n = 2 * lanes + 1
    for start in (0, 150):
        clean = mixed[start : start + n]
        want = call(clean)
        for place in range(n):
            others = np.arange(n) != place
            for spoilt, status in _planted(clean[place]):
                rows = clean.copy()
                rows[place] = spoilt
                got = call(rows)
                assert got.same(want, others), (place, status)
                assert got.status[place] == status, (place, got.status[place], status)
                before = spoilt[[3, 4, 5, 6, 7, 8, 12, 13, 14, 15, 16, 17]]
                assert np.array_equal(got.velocities[place], before, equal_nan=True)
                assert got.good == int((got.status == OK).sum())
    print(f"{n} places, 6 ways to be no collision in each: the others are alike, bit for bit")


def test_arrays_may_lie_anywhere_and_overlap_in_place(kernel, mixed):
    call, _ = kernel
    want = call(mixed)
    for offset in (1, 2, 3, 5, 7):
        assert call(mixed, offset=offset).same(want)
    assert call(mixed, in_place=True).same(want)
    assert call(mixed, in_place=True, offset=3).same(want)


def test_every_collision_has_its_own_friction(kernel, mixed):
    call, _ = kernel
    u_b = np.linspace(0.0, 0.3, len(mixed))
    together = call(mixed, u_b)
    for i in range(0, len(mixed), 7):
        alone = call(mixed[i : i + 1], u_b[i : i + 1])
        assert np.array_equal(alone.velocities[0], together.velocities[i])
    spoilt = u_b.copy()
    spoilt[[3, 100]] = np.nan, 1.5
    got = call(mixed, spoilt)
    others = ~np.isin(np.arange(len(mixed)), [3, 100])
    assert got.same(together, others)
    assert list(got.status[[3, 100]]) == [BAD_INPUT, BAD_INPUT]
    assert call(mixed, np.full(len(mixed), 0.05)).same(call(mixed))


def test_parameters_out_of_range_refuse_every_lane(kernel, mixed):
    call, _ = kernel
    got = call(mixed, parameters=(0.028575, 0.17, 0.2, 0.2, 0.05, 1.5))
    assert got.good == 0
    assert (got.status == BAD_INPUT).all()


@pytest.mark.parametrize("model", MODELS)
def test_batches_are_as_exact_as_single_calls(model):
    """The largest error of each instruction set against the scalar kernel's, on the same cases."""
    tool = bench_tool()
    cases = expected_cases(tool, 20141, 5000)  # as many as the main job has
    euler, exact = cases.euler[model], cases.exact[model]
    chosen = [k for k in KERNELS if read_host().runs(find_target(k[0]))]
    if model != "mathavan2014":
        chosen = chosen[:1] + chosen[-1:]  # the rest differ by what all models share
    variants = [_variant(t, w, model, 1000, o) for t, w, o in chosen]
    scalar = _variant("x86-64-v2", 1, model, 1000, {})
    for each, built in zip([scalar, *variants], build_all([scalar, *variants]), strict=True):
        assert not isinstance(built, KernelError), built
        got = tool.run_kernel(built.path, cases.rows, batch=each.width > 1)
        verdict = euler_verdict(cases.rows, got, euler, exact, 1000)
        print(f"{each.target} x{each.width}: {verdict.max_abs_error:.2g} m/s, {verdict.reason}")
        assert verdict.passed, f"{each.target} x{each.width}: {verdict.reason}"


@pytest.mark.parametrize("model", MODELS)
def test_exact_batches_hold_their_budget(model):
    """The reference, kept hard cases and random ones through lanes, against the oracle."""
    tool = bench_tool()
    cases = np.vstack([load_reference().cases, load_hard()[1], tool.make_cases(77, 3000).rows])
    want = tool.expect(cases, "exact", model)
    chosen = [k for k in EXACT if read_host().runs(find_target(k[0]))]
    variants = [_exact(t, w, model, *rest) for t, w, *rest in chosen]
    for each, built in zip(variants, build_all(variants), strict=True):
        assert not isinstance(built, KernelError), built
        got = tool.run_kernel(built.path, cases, batch=True)
        worst = Worst(each.stepper.budget)
        worst.add(cases, ["all"] * len(cases), got, want)
        single = tool.run_kernel(built.path, cases)
        print(f"{each.target} x{each.width} {each.stepper.goal}: {worst.error:.2g}")
        assert (got[:, STATUS] == single[:, STATUS]).all()
        assert worst.passed, worst.line()
    # What grows with a driven slip first: the other models are under test_worst_estimates.py.
    shaky = [v for v in variants if model == "pooltool" and v["lane_root"] != "inv"]
    for each, built in zip(shaky, build_all(shaky, worst=True), strict=True):
        assert not isinstance(built, KernelError), built
        for pattern in PATTERNS:
            got = tool.run_kernel(
                built.path, cases, batch=True, way=Way(environment=pattern.environment())
            )
            worst = Worst(each.stepper.budget)
            worst.add(cases, ["all"] * len(cases), got, want)
            print(f"{each.target} x{each.width}, {pattern.name}: {worst.error:.2g}")
            assert worst.passed, f"{pattern.name}: {worst.line()}"


def _arcade_rows(rows):
    """Cases with the same table friction for both balls."""
    rows = rows.copy()
    rows[:, 3] = rows[:, 2]
    return rows


def _extremes(n):
    """Slow shots along y with spins and a rise at up to 1e60 times the speed of approach."""
    rng = np.random.default_rng(41)
    rows = np.zeros((n, 24))
    rows[:, :6] = (*PARAMETERS[:4], 0.05, 0.9)
    rows[:, [8, 17]], rows[:, 16] = PARAMETERS[0], 2 * PARAMETERS[0]
    motions = [9, 11, *range(12, 15), *range(21, 24)]
    scales = 10.0 ** rng.uniform(-3, 60, (n, len(motions)))
    usual = rng.random(scales.shape) < 0.6
    scales[usual] = rng.uniform(0.1, 100, int(usual.sum()))
    rows[:, motions] = scales * rng.choice([-1.0, 0.0, 1.0], scales.shape)
    rows[:, 10] = 1.0
    motions.append(10)
    rows[:, motions] *= 10.0 ** rng.uniform(-250, 35, (n, 1))
    return rows


@pytest.mark.parametrize("model", MODELS)
def test_exact_batches_take_what_calls_take_at_any_spin(model):
    """Beside an approach of 1e-60 of the other speeds, too: squares leave the range of float."""
    tool, rows = bench_tool(), _extremes(8000)
    chosen = [k for k in EXACT if read_host().runs(find_target(k[0]))]
    variants = [_exact(t, w, model, *rest) for t, w, *rest in chosen]
    for each, built in zip(variants, build_all(variants), strict=True):
        assert not isinstance(built, KernelError), built
        got, single = (tool.run_kernel(built.path, rows, batch=b) for b in (True, False))
        differ = int((got[:, STATUS] != single[:, STATUS]).sum())
        refused = int((got[:, STATUS] != OK).sum())
        print(
            f"{each.target} x{each.width} {each.stepper.goal}: {refused} refused, {differ} differ"
        )
        assert refused == 0 and differ == 0
        assert np.isfinite(got).all() and np.isfinite(single).all()


@pytest.mark.parametrize("model", MODELS)
def test_float_batches_hold_their_budget(model):
    """As exact batches, for the scene in float; the statuses are those of single calls."""
    tool = bench_tool()
    drawn = tool.make_cases(78, 3000).rows
    cases = _arcade_rows(np.vstack([load_reference().cases, load_hard()[1], drawn]))
    want = tool.expect(cases, "exact", model)
    chosen = [k for k in FLOATS if read_host().runs(find_target(k[0]))]
    if model != "mathavan2014":
        chosen = chosen[-1:]  # the rest differ by what all models share
    variants = [_exact(t, w, model, *rest, scene="arcade") for t, w, *rest in chosen]
    for each, built in zip(variants, build_all(variants), strict=True):
        assert not isinstance(built, KernelError), built
        got, single = (tool.run_kernel(built.path, cases, batch=b) for b in (True, False))
        worst, alone = Worst(each.stepper.budget), Worst(each.stepper.budget)
        worst.add(cases, ["all"] * len(cases), got, want)
        alone.add(cases, ["all"] * len(cases), single, want)
        errors = f"{worst.error:.3g}, single calls {alone.error:.3g}"
        print(f"{each.target} x{each.width} {each.stepper.goal}: {errors}")
        assert (got[:, STATUS] == single[:, STATUS]).all()
        assert worst.passed, worst.line()


def test_float_lanes_are_as_good_far_away_and_at_any_speed():
    """Directions, speeds and statuses are in double: float would lose or overflow each of these."""
    tool = bench_tool()
    target, width, *rest = [k for k in FLOATS if read_host().runs(find_target(k[0]))][-1]
    variant = _exact(target, width, "mathavan2014", *rest, scene="arcade")
    library, budget = _built(variant), variant.stepper.budget
    cases = _arcade_rows(tool.make_cases(79, 500).rows)
    far, slow, fast, rising = (cases.copy() for _ in range(4))
    far[:, [6, 7, 15, 16]] += 1e4
    velocities = [*range(9, 15), *range(18, 24)]
    slow[:, velocities] *= 1e-60
    fast[:, velocities] *= 1e60
    rising[:, 17] += 4e-6 * cases[:, 0]  # tilted, by hardly more than counts as level
    for name, rows in (("far", far), ("slow", slow), ("fast", fast), ("rising", rising)):
        got, single = (tool.run_kernel(library.path, rows, batch=b) for b in (True, False))
        worst = Worst(budget)
        worst.add(rows, [name] * len(rows), got, tool.expect(rows, "exact", "mathavan2014"))
        print(f"{name}: {worst.error:.3g}, statuses {np.unique(got[:, STATUS])}")
        assert (got[:, STATUS] == single[:, STATUS]).all(), name
        assert (got[:, STATUS] == (TILTED if name == "rising" else OK)).all(), name
        assert worst.passed, worst.line()


@pytest.mark.parametrize("spin", [1e7, 1e9])
def test_steps_in_floats_hold_beside_any_spin(spin):
    """Floats lose an approach beside slips that are 1e8 times as fast, if they are let."""
    tool = bench_tool()
    target, width, *rest = [k for k in STEPS_IN_FLOATS if read_host().runs(find_target(k[0]))][-1]
    variant = _exact(target, width, "mathavan2014", *rest)
    rows = tool.make_cases(80, 1000).rows
    rows[:, 12] = spin  # rad/s, of ball 1 about x
    got = tool.run_kernel(_built(variant).path, rows, batch=True)
    worst = Worst(variant.stepper.budget)
    worst.add(rows, ["fast spin"] * len(rows), got, tool.expect(rows, "exact", "mathavan2014"))
    print(f"{variant.target} x{width}, {spin:g} rad/s: {worst.error:.2g}")
    assert worst.passed, worst.line()


def test_a_batch_may_be_shared_over_threads():
    """The outcomes of two and three threads are those of one, bit for bit; the scaling is shown."""
    tool = bench_tool()
    target, width, options = max(
        (k for k in KERNELS if read_host().runs(find_target(k[0]))), key=lambda k: k[1]
    )
    library = _built(_variant(target, width, "mathavan2014", 40, options))
    rows = tool.make_cases(3, 500, fixed={"u_s1": 0.2, "u_s2": 0.2, "e_b": 0.9}).rows
    found = tool.threads(library.path, rows, 4096, most=3)
    alone = found[1]
    print({n: f"{ns:.1f} ns, {alone / ns:.2f} times as fast" for n, ns in found.items()})
    assert list(found) == [1, 2, 3]
