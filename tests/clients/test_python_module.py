"""`pip install .`: the module carom, and the command gen away from any clone."""

from __future__ import annotations

import shutil
import sys
import threading
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from generator.clients.kernel_set import BUDGETS, STEPS, TARGETS, UNEQUAL, UNEQUAL_MODELS
from generator.impacts.ball_ball.evidence import PUBLISHED
from generator.impacts.ball_ball.evidence.fixed_steps import euler_verdict
from generator.impacts.ball_ball.evidence.measure import OUTCOME_COLUMNS, errors_of
from generator.impacts.ball_ball.evidence.scene_cases import cases_for_scene
from generator.impacts.ball_ball.models import MODELS
from generator.impacts.ball_ball.parameters import CASE_M1, LIMITS
from generator.impacts.ball_ball.scene import find_scene
from generator.targets.host import read_host
from generator.targets.target import find_target
from tests.support.installed import ROOT, carom, run, site
from tests.support.kernels import bench_tool
from tests.support.reference import load_reference

RUNNABLE = [name for name in TARGETS if read_host().runs(find_target(name))]
NAMES = [model.name for model in MODELS]


def by_call(kernel, parameters, case: np.ndarray) -> list[float]:
    ball1, ball2 = case[6:15].reshape(3, 3), case[15:24].reshape(3, 3)
    out1, out2, status = kernel.collide(parameters, ball1, ball2)
    return [*out1[1:].ravel(), *out2[1:].ravel(), status]


def by_batch(kernel, parameters, case: np.ndarray) -> list[float]:
    out, status = kernel.collide_batch(parameters, case[6:].reshape(18, 1))
    return [*out[:, 0], status[0]]


WAYS = (by_call, by_batch)


def outcomes(way, kernel, cases: np.ndarray) -> np.ndarray:
    """Rows of 13 as the bench gives them; one case a call, since parameters differ by case."""
    return np.array([way(kernel, carom().Parameters(*case[:6]), case) for case in cases])


def million_like(count: int) -> tuple[object, np.ndarray]:
    """Parameters and columns of balls: the reference's, over and over."""
    rows = load_reference().cases[:, 6:]
    return carom().Parameters(), np.resize(rows, (count, 18)).T.copy()


# ---- kernels ---------------------------------------------------------------------------------


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("target", RUNNABLE)
@pytest.mark.parametrize("budget", BUDGETS)
@pytest.mark.parametrize("model", NAMES)
def test_every_exact_kernel_keeps_its_budget(model, budget, target, way) -> None:
    reference = load_reference()
    kernel = carom().Kernel(model, max_error=budget, target=target)
    got = outcomes(way, kernel, reference.cases)
    error = errors_of(reference.cases, got, reference.exact[model]).relative
    print(f"{kernel.name}: largest error {error.max():.2g} of {budget:g}")
    assert np.array_equal(got[:, 12], reference.exact[model][:, 12])
    assert error.max() <= budget


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("target", RUNNABLE)
def test_fixed_steps_are_those_of_pooltool(target, way) -> None:
    reference = load_reference()
    kernel = carom().Kernel("pooltool", steps=STEPS, target=target)
    got = outcomes(way, kernel, reference.cases)
    exact = reference.exact["pooltool"]
    theirs = np.hstack([reference.published[PUBLISHED][:, :OUTCOME_COLUMNS], exact[:, 13:]])
    verdict = euler_verdict(reference.cases, got, theirs, exact, STEPS)
    print(f"{kernel.name}: {verdict.reason}; largest difference {verdict.max_abs_error:.2g} m/s")
    assert verdict.passed, verdict.reason


def test_the_loosest_kernel_that_keeps_a_budget_is_taken() -> None:
    kernel = carom().Kernel
    assert kernel().max_error == 1e-6 and kernel().steps is None
    assert kernel(max_error=0.5).max_error == 1e-3
    assert kernel(max_error=9.9e-4).max_error == 1e-6
    assert kernel(steps=1000).steps == 1000 and kernel(steps=1000).max_error is None
    assert kernel().target == RUNNABLE[0]


CHOICE = """
import sys
sys.path += sys.argv[1:]
import carom
import numpy as np
kernel = carom.Kernel("mathavan2014")
ball1, ball2 = np.zeros((3, 3)), np.zeros((3, 3))
ball1[1, 1], ball2[0, 1] = 2.0, 0.057
print(kernel.target, int(kernel.collide(carom.Parameters(), ball1, ball2)[2]))
"""


@pytest.mark.skipif(shutil.which("qemu-x86_64") is None, reason="no qemu-x86_64")
@pytest.mark.parametrize(
    ("cpu", "target"), [("Nehalem", "x86-64-v2"), ("Haswell", "x86-64-v3"), ("EPYC", "x86-64-v3")]
)
def test_the_cpu_decides_which_kernel_is_taken(cpu: str, target: str) -> None:
    """On emulated CPUs of two makers, with AVX2 and without."""
    python = Path(sys.executable).resolve()
    libraries = (site(), *(path for path in sys.path if path.endswith("site-packages")))
    told = run(["qemu-x86_64", "-cpu", cpu, python, "-c", CHOICE, *libraries])
    print(f"{cpu}: {told}")
    assert told.splitlines()[-1] == f"{target} 0"


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ({"model": "billiards"}, ("'billiards'", "mathavan2014, bottom_slip, pooltool")),
        ({"max_error": 1e-12}, ("1e-12", "0.001, 1e-06, 1e-09")),
        ({"max_error": float("nan")}, ("nan", "1e-09")),
        ({"target": "zen3"}, ("'zen3'", "x86-64-v4, x86-64-v3, x86-64-v2")),
        ({"steps": 0}, ("steps", "1 to 100000000")),
        ({"steps": 10, "max_error": 1e-3}, ("exclude each other",)),
    ],
)
def test_wrong_requests_name_what_there_is(arguments, parts) -> None:
    with pytest.raises(ValueError) as caught:
        carom().Kernel(**arguments)
    for part in parts:
        assert part in str(caught.value)


@pytest.mark.parametrize("target", RUNNABLE)
@pytest.mark.parametrize("budget", BUDGETS)
@pytest.mark.parametrize("model", UNEQUAL_MODELS)
def test_two_masses_are_those_of_the_oracle(model, budget, target) -> None:
    """By calls, and as a batch of one. M is the mass of ball 2, M1 that of ball 1."""
    cases = cases_for_scene(find_scene(UNEQUAL), load_reference().cases, model)
    exact = bench_tool().expect(cases, "exact", model, more=[f"mass1={CASE_M1!r}"])
    kernel = carom().Kernel(model, max_error=budget, target=target)
    given = [carom().Parameters(*case[:6], M1=CASE_M1) for case in cases]
    got = np.array([by_call(kernel, p, case) for p, case in zip(given, cases, strict=True)])
    error = errors_of(cases, got, exact).relative
    print(f"{kernel.name}: largest error {error.max():.2g} of {budget:g}")
    assert np.array_equal(got[:, 12], exact[:, 12])
    assert error.max() <= budget
    for p, case, row in zip(given, cases[:20], got[:20], strict=False):
        assert np.array_equal(by_batch(kernel, p, case), row)


def test_a_second_mass_is_shown_held_to_its_range_and_refused_where_it_is_none() -> None:
    parameters, one = carom().Parameters, load_reference().cases[0]
    assert parameters().M1 == parameters().M and "M1" not in repr(parameters())
    assert "M1=0.2)" in repr(parameters(M=0.1, M1=0.2))
    kernel = carom().Kernel("mathavan2014")
    for M1 in (0.01, 1.0):
        assert by_call(kernel, parameters(M=0.1, M1=M1), one)[12] == carom().Status.OK
    for M1 in (0.0099, 1.01, -0.1, float("nan")):
        with pytest.raises(ValueError, match=rf"M1 = {M1} is out of range: expected 0.1 to 10 tim"):
            parameters(M=0.1, M1=M1)
    for other in (carom().Kernel("pooltool"), carom().Kernel("mathavan2014", steps=1000)):
        for way in WAYS:
            with pytest.raises(ValueError, match="M1: only kernels with max_error and of the mod"):
                way(other, parameters(M=0.1, M1=0.2), one)


# ---- arrays ----------------------------------------------------------------------------------


GOALS = [{"max_error": 1e-6}, {"steps": 1000}, {"steps": 300}]


def test_batches_go_in_the_widest_lanes_of_each_level() -> None:
    """Of floats where the budget allows them: twice as many."""
    widths = {"x86-64-v2": 2, "x86-64-v3": 4, "x86-64-v4": 8}
    for target in RUNNABLE:
        for goal in (*GOALS, {"max_error": 1e-9}):
            kernel = carom().Kernel(target=target, **goal)
            lanes = widths[target] * (2 if goal.get("max_error") == 1e-6 else 1)
            assert kernel.lanes == (1 if kernel.steps == 300 else lanes), kernel.name


@pytest.mark.parametrize("goal", GOALS)
def test_a_collision_in_a_batch_depends_on_itself_alone(goal) -> None:
    kernel = carom().Kernel("mathavan2014", **goal)
    parameters, balls = million_like(1000)
    out, status = kernel.collide_batch(parameters, balls)
    for i in range(0, 1000, 37):
        alone, state = kernel.collide_batch(parameters, balls[:, i : i + 1])
        assert state[0] == status[i]
        assert np.array_equal(alone[:, 0], out[:, i], equal_nan=True)


def test_batches_of_another_number_of_steps_are_single_calls() -> None:
    kernel, (parameters, balls) = carom().Kernel(steps=300), million_like(100)
    out, status = kernel.collide_batch(parameters, balls)
    for i in range(100):
        one, two, state = kernel.collide(parameters, *balls[:, i].reshape(2, 3, 3))
        single = np.concatenate([one[1:].ravel(), two[1:].ravel()])
        assert state == status[i] and np.array_equal(single, out[:, i], equal_nan=True)


@pytest.mark.parametrize("goal", GOALS)
def test_batches_are_the_same_in_any_layout(goal) -> None:
    kernel = carom().Kernel("mathavan2014", **goal)
    parameters, balls = million_like(1000)
    out, status = kernel.collide_batch(parameters, balls)
    assert out.shape == (12, 1000) and status.shape == (1000,) and status.dtype == np.uint8
    rows = balls.T.copy()
    strided, _ = kernel.collide_batch(parameters, rows.T)
    assert np.array_equal(strided, out, equal_nan=True)
    places = np.full((1000, 12), np.nan), np.full(1000, 99, np.uint8)
    same, marks = kernel.collide_batch(parameters, rows.T, out=places[0].T, status=places[1])
    assert np.array_equal(places[0].T, out, equal_nan=True) and np.array_equal(places[1], status)
    assert np.shares_memory(same, places[0]) and np.shares_memory(marks, places[1])
    part, _ = kernel.collide_batch(parameters, balls[:, 100:400])
    assert np.array_equal(part, out[:, 100:400], equal_nan=True)


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc to measure by")
def test_results_hold_no_more_than_their_own_size() -> None:
    """Also those of a kernel that is gone, and a kernel no more than its last result."""
    text = run([sys.executable, ROOT / "tests/support/result_memory.py", site()])
    print(text)
    held = {line.split(": ")[0]: float(line.split()[-2]) for line in text.splitlines()}
    assert len(held) == 6
    large = held.pop("58 MB after 97 MB, kernel gone")
    assert large < 58.2 + 8 and max(held.values()) < 8, held


def test_memory_of_results_is_given_out_again_only_when_they_are_dropped() -> None:
    kernel, (parameters, balls) = carom().Kernel(), million_like(50_000)
    first, marks = kernel.collide_batch(parameters, balls)
    place, row = first.ctypes.data, first[3]
    before, states = first.copy(), marks.copy()
    other, _ = kernel.collide_batch(parameters, -balls)
    assert not np.shares_memory(first, other)
    del first  # a row and the statuses are still held
    kernel.collide_batch(parameters, -balls)
    assert np.array_equal(row, before[3]) and np.array_equal(marks, states)
    del row, marks
    again, _ = kernel.collide_batch(parameters, balls)
    assert again.ctypes.data == place and np.array_equal(again, before, equal_nan=True)
    small, _ = kernel.collide_batch(parameters, balls[:, :100])
    assert np.array_equal(small, before[:, :100], equal_nan=True)
    del kernel
    assert np.array_equal(again, before, equal_nan=True) and again.flags.writeable


def test_friction_by_collision() -> None:
    kernel, (parameters, balls) = carom().Kernel(), million_like(200)
    u_b = np.linspace(0.0, 0.2, 200)
    out, _ = kernel.collide_batch(parameters, balls, u_b=u_b)
    for i in (0, 77, 199):
        own = carom().Parameters(u_b=u_b[i])
        alone, _ = kernel.collide_batch(own, balls[:, i : i + 1])
        assert np.array_equal(alone[:, 0], out[:, i])


def test_what_comes_in_is_left_alone_and_into_may_alias() -> None:
    kernel, (parameters, balls) = carom().Kernel(), million_like(1)
    ball1, ball2 = balls[:, 0].reshape(2, 3, 3)
    before = balls.copy()
    out1, out2, status = kernel.collide(parameters, ball1, ball2)
    assert np.array_equal(balls, before) and status == carom().Status.OK
    assert kernel.collide_into(parameters, ball1, ball2, ball1, ball2) == status
    assert np.array_equal(ball1, out1) and np.array_equal(ball2, out2)


def test_other_numbers_and_orders_are_converted() -> None:
    kernel, parameters = carom().Kernel(), carom().Parameters()
    ball1 = np.array([[0, 0, 0], [0, 2, 0], [-30, 0, 0]])
    ball2 = np.array([[0, 1, 0], [0, 0, 0], [0, 0, 0]])
    whole = kernel.collide(parameters, ball1, ball2)
    for given in (
        (np.asfortranarray(ball1, float), ball2.astype(np.float32)),
        (ball1.tolist(), tuple(map(tuple, ball2))),
        (list(ball1), ball2.tolist()),
    ):
        again = kernel.collide(parameters, *given)
        assert np.array_equal(whole[0], again[0]) and np.array_equal(whole[1], again[1])
    out, status = kernel.collide_batch(parameters, million_like(5)[1][:, :0])
    assert out.shape == (12, 0) and status.shape == (0,)


@pytest.mark.parametrize("goal", GOALS)
def test_columns_rows_lists_and_pairs_of_balls_give_the_same_results(goal) -> None:
    """(18, n), (n, 18), and two (n, 3, 3), also where they lie apart in memory."""
    kernel = carom().Kernel("mathavan2014", **goal)
    parameters, balls = million_like(300)
    out, status = kernel.collide_batch(parameters, balls)
    rows = balls.T.copy()
    both = rows.reshape(300, 2, 3, 3)
    for given in (rows, rows.tolist(), np.asfortranarray(rows), rows.astype(object).astype(float)):
        got, marks = kernel.collide_batch(parameters, given)
        assert got.shape == (300, 12)
        assert np.array_equal(got.T, out, equal_nan=True) and np.array_equal(marks, status)
    given_place = np.full((300, 12), np.nan)
    kernel.collide_batch(parameters, rows, out=given_place)
    assert np.array_equal(given_place.T, out, equal_nan=True)
    for pair in ((both[:, 0], both[:, 1]), (both[:, 0].tolist(), both[:, 1].copy())):
        one, two, marks = kernel.collide_batch(parameters, *pair)
        assert one.shape == two.shape == (300, 3, 3) and np.array_equal(marks, status)
        assert np.array_equal(one[:, 0], both[:, 0, 0], equal_nan=True)
        assert np.array_equal(two[:, 0], both[:, 1, 0], equal_nan=True)
        velocities = np.concatenate([one[:, 1:], two[:, 1:]], axis=1).reshape(300, 12)
        assert np.array_equal(velocities.T, out, equal_nan=True)


def test_friction_is_a_number_or_one_a_collision() -> None:
    kernel, (parameters, balls) = carom().Kernel(), million_like(50)
    both = balls.T.reshape(50, 2, 3, 3)
    want, _ = kernel.collide_batch(parameters.replace(u_b=0.1), balls)
    spread = np.repeat(0.1, 100)[::2]
    for u_b in (0.1, np.float32(0.1).astype(float), np.array(0.1), [0.1] * 50, spread):
        got, _ = kernel.collide_batch(parameters, balls, u_b=u_b)
        one, _, _ = kernel.collide_batch(parameters, both[:, 0], both[:, 1], u_b=u_b)
        tolerance = 1e-6 * np.abs(want).max()
        assert np.allclose(got, want, atol=tolerance)
        assert np.array_equal(one[:, 1:].reshape(50, 6).T, got[:6], equal_nan=True)


def test_wrong_shapes_and_types_are_named_with_what_came_and_what_is_needed() -> None:
    kernel, p = carom().Kernel(), carom().Parameters()
    good, balls = np.array([[0, 0, 0], [0, 2, 0], [-30, 0, 0.0]]), million_like(5)[1]
    frozen = good.copy()
    frozen.flags.writeable = False
    ball, many = "expected numbers of shape \\(3, 3\\)", np.zeros((5, 3, 3))
    for call, message in {
        lambda: kernel.collide({}, good, good): "parameters: expected carom.Parameters; dict came",
        lambda: kernel.collide(p, good[:2], good): f"ball1: {ball}.* float64 .* \\(2, 3\\) came",
        lambda: kernel.collide(p, good, good.ravel()): f"ball2: {ball}.* shape \\(9,\\) came",
        lambda: kernel.collide(p, good, "balls"): f"ball2: {ball}.*; str came",
        lambda: kernel.collide(p, None, good): f"ball1: {ball}.*; NoneType came",
        lambda: kernel.collide(p, [[1, 2, 3], [1]], good): f"ball1: {ball}.*; list came",
        lambda: kernel.collide(p, good + 1j, good): f"ball1: {ball}.* complex128 array",
        lambda: kernel.collide_into(p, good, good, good, frozen): "out2: expected a writable",
        lambda: kernel.collide_into(
            p, good, good, good.astype("f4"), good
        ): "out1: .*float32 array",
        lambda: kernel.collide_batch(
            p, balls[:17]
        ): "balls: .*\\(18, n\\) or \\(n, 18\\).*\\(17, 5\\)",
        lambda: kernel.collide_batch(p, many): "balls: .*two arguments of shape \\(n, 3, 3\\)",
        lambda: kernel.collide_batch(p, many, balls): "ball2: .*\\(n, 3, 3\\).*\\(18, 5\\) came",
        lambda: kernel.collide_batch(p, balls, u_b="high"): "u_b: expected a number, or one",
        lambda: kernel.collide_batch(p, balls, out=np.empty((12, 5), "f4")): "out: .*float32 array",
        lambda: kernel.collide_batch(p, balls, status=[0] * 5): "status: .*uint8.*; list came",
        lambda: carom().Kernel(7): "model: expected a str; int came",
        lambda: carom().Kernel(steps=1.5): "steps: expected a whole number.*; float came",
        lambda: carom().Kernel(max_error="small"): "max_error: expected a number; str came",
        lambda: carom().Parameters(R="big"): "R: expected a number; str came",
    }.items():
        with pytest.raises(TypeError, match=message):
            call()
    for call, message in {
        lambda: kernel.collide_batch(p, balls, u_b=np.zeros(4)): "u_b: .* a collision, 5; 4 came",
        lambda: kernel.collide_batch(p, balls, u_b=1.5): "u_b = 1.5 is out of range: expected 0 to",
        lambda: kernel.collide_batch(
            p, balls, out=np.empty((12, 4))
        ): "out: .*\\(12, 5\\); .* came",
        lambda: kernel.collide_batch(p, balls, status=np.empty(6, "u1")): "status: .* 5; 6 came",
        lambda: kernel.collide_batch(p, many, many[:4]): "ball2: .* as ball1 has, 5; 4 came",
    }.items():
        with pytest.raises(ValueError, match=message):
            call()


@pytest.mark.parametrize("name", ["R", "M", "u_s1", "u_s2", "u_b", "e_b"])
def test_parameters_out_of_range_are_refused_when_made_with_name_and_range(name) -> None:
    low, high = LIMITS[name]
    wanted = rf"^{name} = .* is out of range: expected {low:g} to {high:g}$".replace("+", r"\+")
    for value in (low - 1e-9, high * 1.001, float("nan"), float("inf")):
        with pytest.raises(ValueError, match=wanted):
            carom().Parameters(**{name: value})
        with pytest.raises(ValueError, match=wanted):
            carom().Parameters().replace(**{name: value})
    for value in (low, high):
        assert getattr(carom().Parameters(**{name: value}), name) == value


def test_other_threads_run_during_a_batch() -> None:
    kernel = carom().Kernel("pooltool", steps=1000)
    parameters, balls = million_like(10_000)
    batch = threading.Thread(target=kernel.collide_batch, args=(parameters, balls))
    batch.start()
    turns = 0
    while batch.is_alive():
        turns += 1
    print(f"{turns} turns of the main thread during a batch")
    assert turns > 1000


def test_other_threads_run_during_a_long_call() -> None:
    """A call of many steps gives the interpreter's lock away; others see it all the time."""
    kernel, parameters = carom().Kernel("pooltool", steps=20_000_000), carom().Parameters()
    ball1, ball2 = million_like(1)[1][:, 0].reshape(2, 3, 3)
    call = threading.Thread(target=kernel.collide, args=(parameters, ball1, ball2))
    call.start()
    turns = 0
    while call.is_alive():
        turns += 1
    print(f"{turns} turns of the main thread during a call")
    assert turns > 1000


def test_the_example_runs(tmp_path) -> None:
    """A stun shot leaves at right angles but for throw and lost energy, whatever the cut."""
    example = ROOT / "examples" / "python" / "stun_line.py"
    text = run([sys.executable, "-P", example], PYTHONPATH=str(site()))
    print(text)
    angles = [float(line.split()[1]) for line in text.splitlines()[2:]]
    assert len(angles) == 8 and all(79 < angle < 90 for angle in angles)


def test_a_shot_is_searched_among_a_hundred_thousand_aims(tmp_path) -> None:
    """The picture has its marks, and the best plan works nearly always."""
    example, drawn = ROOT / "examples" / "python" / "shot_search.py", tmp_path / "shot_search.svg"
    text = run([sys.executable, "-P", example, drawn], PYTHONPATH=str(site()))
    print(text)
    assert text.startswith("102400 aims, 1638400 collisions in ")
    assert int(text.split()[-1].removesuffix("%")) >= 90
    marks = ET.parse(drawn).getroot().findall("{http://www.w3.org/2000/svg}rect")
    assert len(marks) > 200


# ---- gen, from anywhere ----------------------------------------------------------------------


def gen(folder: Path, *arguments: object) -> str:
    """What `gen` prints, called in a folder that has nothing to do with the clone."""
    command = ["env", "-C", folder, site() / "bin" / "gen", *arguments]
    places = {"XDG_CACHE_HOME": str(folder / "cache"), "CAROM_CACHE": ""}
    return run(command, PYTHONPATH=str(site()), PYTHONSAFEPATH="1", **places)


def test_gen_derives_and_lists_anywhere(tmp_path) -> None:
    assert "zen3" in gen(tmp_path, "list", "targets")
    assert "dc_x = 7*d_x" in gen(tmp_path, "explain", "paper-best")
    assert list(tmp_path.iterdir()) == []


def test_gen_collides_anywhere(tmp_path) -> None:
    lines = (site() / "carom_gen/sources/tests/data/reference/inputs.csv").read_text("utf-8")
    (tmp_path / "in.csv").write_text("\n".join(lines.splitlines()[:20]) + "\n")
    text = gen(tmp_path, "collide", "--cases", "in.csv", "--out", "out.csv")
    assert "19 cases" in text
    assert {p.name for p in tmp_path.iterdir()} == {"in.csv", "out.csv", "cache"}
    assert [p.name for p in (tmp_path / "cache").iterdir()] == ["carom"]
