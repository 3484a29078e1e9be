"""What carom.h promises for input that no table sees: through C, as a user calls it."""

from __future__ import annotations

import ctypes
import math
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from generator.impacts.ball_ball.evidence import MODELS
from generator.impacts.ball_ball.presets import find_preset
from generator.toolchain.build import BuiltLibrary
from tests.support.kernels import build_all, variant
from tests.support.reference import load_reference

OK, SEPARATING, BAD_INPUT, TILTED = range(4)
R, M = 0.028575, 0.170097
NAN, INF = math.nan, math.inf
FAMILIES = {
    "div": {},
    "reduced": find_preset("reduced").options,
    "ahead": find_preset("reduced-ahead").options,
    "inverted": {**find_preset("paper-best").options, "flags": "strict"},
    "balls": {**find_preset("paper-simd-rewritten").options, "flags": "strict"},
    "prev": {"rsqrt": "prev", "roots": "early", "state": "reduced", "reuse": "precompute"},
    "fast": find_preset("paper-best").options,
}


class Params(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in ("R", "M", "u_s1", "u_s2", "u_b", "e_b")]


Nine = ctypes.c_double * 9


@dataclass
class Kernel:
    """A loaded kernel; balls are lists of nine."""

    model: str
    library: ctypes.CDLL
    exact_bits: bool  # IEEE arithmetic: the same wherever it is inlined

    def collide(self, ball1, ball2, params=(R, M, 0.2, 0.2, 0.05, 0.95), steps=None):
        one, two, out1, out2 = Nine(*ball1), Nine(*ball2), Nine(), Nine()
        p = Params(*params)
        start = time.process_time()
        if steps is None:
            status = self.library.carom_collide(ctypes.byref(p), one, two, out1, out2)
        else:
            status = self.library.carom_collide_steps(ctypes.byref(p), one, two, out1, out2, steps)
        assert time.process_time() - start < 1.0
        assert bytes(one) == bytes(Nine(*ball1)), "the input was written to"
        if status != OK:
            assert bytes(out1) == bytes(one) and bytes(out2) == bytes(two), "not as they came"
        else:
            assert all(map(math.isfinite, [*out1, *out2])), (list(out1), list(out2))
        return status, list(out1), list(out2)


@pytest.fixture(scope="module")
def libraries() -> dict[tuple[str, str], Kernel]:
    keys = [(name, model) for name in FAMILIES for model in MODELS]
    built = build_all([variant(model=model, **FAMILIES[name]) for name, model in keys])
    assert all(isinstance(b, BuiltLibrary) for b in built), built
    return {
        k: Kernel(k[1], _loaded(b.path), k[0] != "fast") for k, b in zip(keys, built, strict=True)
    }


def _loaded(path: Path) -> ctypes.CDLL:
    library = ctypes.CDLL(str(path))
    library.carom_kernel.restype = ctypes.c_char_p
    library.carom_collide_batch.restype = ctypes.c_size_t
    return library


@pytest.fixture(params=[f"{n}-{m}" for n in FAMILIES for m in MODELS])
def kernel(request: pytest.FixtureRequest, libraries) -> Kernel:
    return libraries[tuple(request.param.split("-"))]


def balls(v1=(0.3, 1.0, 0.0), w1=(-35.0, 4.0, 9.0), v2=(0.0, 0.0, 0.0), w2=(0.0, 0.0, 0.0)):
    return [0.0, 0.0, R, *v1, *w1], [0.0, 2 * R, R, *v2, *w2]


def test_an_ordinary_shot(kernel: Kernel) -> None:
    status, out1, out2 = kernel.collide(*balls())
    assert status == OK
    assert out1[:3] == [0, 0, R] and out2[:3] == [0, 2 * R, R]
    assert out2[4] > 0.9 > out1[4]


@pytest.mark.parametrize("v2", [(0.3, 1.0, 0), (0, 2.0, 0), (0, 1.0, 0)])
def test_what_does_not_approach_is_left_alone(kernel: Kernel, v2) -> None:
    assert kernel.collide(*balls(v2=v2))[0] == SEPARATING


@pytest.mark.parametrize("gap", [1e-13, 1e-15, 1e-300, 5e-324])
def test_hardly_approaching_ends(kernel: Kernel, gap: float) -> None:
    status, out1, out2 = kernel.collide(*balls(v1=(0.3, gap, 0.0), w1=(-35.0, 4.0, 9.0)))
    assert status == OK
    assert abs(out1[4]) < 1e-6 and abs(out2[4]) < 1e-6
    # Both balls fast, and hardly any difference: v_n is rounding.
    fast = np.nextafter(1.0, 2.0)
    status, out1, _ = kernel.collide(*balls(v1=(0.0, fast, 0.0), v2=(0.0, 1.0, 0.0)))
    assert status == OK and abs(out1[4] - 1) < 1e-6


def test_every_number_that_is_none_is_bad_input(kernel: Kernel) -> None:
    for value in (NAN, INF, -INF):
        for ball in (0, 1):
            for index in range(9):
                pair = balls()
                pair[ball][index] = value
                assert kernel.collide(*pair)[0] == BAD_INPUT, (ball, index, value)
        for index in range(6):
            params = [R, M, 0.2, 0.2, 0.05, 0.95]
            params[index] = value
            assert kernel.collide(*balls(), params)[0] == BAD_INPUT, (index, value)


@pytest.mark.parametrize(
    ("index", "value"),
    [
        *((0, 0.0), (0, -R), (0, 1e-310), (1, 0.0), (1, -1.0), (1, 5e-324), (2, -0.1)),
        *((3, -1e-9), (2, 1.1), (4, -0.01), (4, 1.5), (5, -0.1), (5, 1.01)),
    ],
)
def test_parameters_out_of_range_are_bad_input(kernel: Kernel, index: int, value: float) -> None:
    params = [R, M, 0.2, 0.2, 0.05, 0.95]
    params[index] = value
    assert kernel.collide(*balls(), params)[0] == BAD_INPUT


@pytest.mark.parametrize("e_b", [0.0, 1.0])
@pytest.mark.parametrize("u_b", [0.0, 0.6, 1.0])
@pytest.mark.parametrize("u_s", [0.0, 1.0])
def test_edges_of_the_ranges_collide(kernel: Kernel, e_b: float, u_b: float, u_s: float) -> None:
    params = (R, M, u_s, u_s, u_b, e_b)
    shots = (balls(), balls(w1=(0, 0, 0)), balls(v1=(0, 1, 0), w1=(0, 0, 0)))
    for shot in (*shots, balls(w1=(2000, 0, 0)), balls(v1=(0.02 * 2 * R, 1, 0), w1=(0, 0, 0.02))):
        status, out1, out2 = kernel.collide(*shot, params)
        assert status == OK
        before = shot[0][4] + shot[1][4]
        assert u_s or out1[4] + out2[4] == pytest.approx(before, abs=1e-9)


def test_centres(kernel: Kernel) -> None:
    one, two = balls()
    assert kernel.collide(one, [*one[:3], *two[3:]])[0] == BAD_INPUT  # coincident
    above = [0, 0, 3 * R, *two[3:]]
    tilted = [0, 2 * R, 1.1 * R, *two[3:]]
    rounded = [0, 2 * R, R * (1 + 1e-12), *two[3:]]
    if kernel.model == "pooltool":
        assert kernel.collide(one, tilted)[0] == OK
        assert kernel.collide(one, above)[0] in (OK, SEPARATING)
    else:
        assert kernel.collide(one, tilted)[0] == TILTED
        assert kernel.collide(one, above)[0] == TILTED
    status, out1, _ = kernel.collide(one, rounded)
    assert status == OK
    plain = kernel.collide(one, two)[1]
    for distance in (1e-6 * R, R, 40 * R, 1e6):  # overlap and gaps: only the direction counts
        status, out1, _ = kernel.collide(one, [0, distance, R, *two[3:]])
        assert status == OK and out1 == pytest.approx(plain, abs=1e-12)
    huge = [0, 1e200, R, *two[3:]]
    assert kernel.collide(one, huge)[0] == BAD_INPUT


@pytest.mark.parametrize("speed", [1e101, 1e160, 1e308])
def test_beyond_all_speeds_is_bad_input(kernel: Kernel, speed: float) -> None:
    assert kernel.collide(*balls(v1=(0, speed, 0)))[0] == BAD_INPUT
    assert kernel.collide(*balls(w1=(speed / R, 0, 0)))[0] == BAD_INPUT


@pytest.mark.parametrize("scale", [1e-320, 1e-300, 1e-160, 1e-20, 1e30, 1e98])
def test_any_scale_ends_and_is_finite(kernel: Kernel, scale: float) -> None:
    one, two = balls()
    shot = [*one[:3], *(scale * x for x in one[3:])], two
    status, out1, out2 = kernel.collide(*shot)
    assert status == OK
    if 1e-12 < scale < 1e90:
        same = kernel.collide(one, two)
        for got, want in zip((out1, out2), same[1:], strict=True):
            assert np.array(got[3:]) / scale == pytest.approx(want[3:], rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("speed", [1e-90, 1e-104, 1e-120, 1e-145])
def test_a_spinning_ball_that_hardly_approaches_gives_numbers(kernel: Kernel, speed: float) -> None:
    """The table slip of the ball at rest then has an inverse that cannot be cubed (a fuzzer)."""
    one, two = balls(v1=(0, speed, 0), w1=(1431.0, 0, 0))
    for steps in (None, 300):
        status, out1, out2 = kernel.collide(one, two, steps=steps)
        assert status == OK
        assert np.abs([*out1[3:6], *out2[3:6]]).max() < 20 * speed + 1e-14


def test_outputs_may_be_inputs(kernel: Kernel) -> None:
    _, want1, want2 = kernel.collide(*balls())
    p = Params(R, M, 0.2, 0.2, 0.05, 0.95)
    one, two = (Nine(*ball) for ball in balls())
    assert kernel.library.carom_collide(ctypes.byref(p), one, two, one, two) == OK
    assert (list(one), list(two)) == (want1, want2)
    one, two = (Nine(*ball) for ball in balls())
    assert kernel.library.carom_collide(ctypes.byref(p), one, two, two, one) == OK
    assert (list(two), list(one)) == (want1, want2)


def test_steps_are_bounded(kernel: Kernel) -> None:
    for steps in (0, -1, -(2**31), 100_000_001, 2**31 - 1):
        assert kernel.collide(*balls(), steps=steps)[0] == BAD_INPUT
    few = kernel.collide(*balls(), steps=1)
    many = kernel.collide(*balls(), steps=20000)
    assert few[0] == many[0] == OK
    assert kernel.collide(*balls())[2] == pytest.approx(many[2], abs=0.05)
    assert kernel.collide(*balls(), steps=1000) == kernel.collide(*balls())


def test_batch(kernel: Kernel) -> None:
    rows = load_reference().cases[:40].copy()
    rows[:, :6] = (R, M, 0.2, 0.2, 0.05, 0.95)
    rows[5, 9] = NAN
    rows[6, 18:21] = 2 * rows[6, 9:12]
    n = len(rows)
    double = ctypes.POINTER(ctypes.c_double)
    columns = [np.ascontiguousarray(rows[:, 6 + k]) for k in range(18)]
    u_b = np.linspace(0.0, 0.1, n)
    pointers = (double * 18)(*(c.ctypes.data_as(double) for c in columns))
    p = Params(R, M, 0.2, 0.2, 0.05, 0.95)

    def run(friction, count, status, out) -> int:
        places = (double * 12)(*(c.ctypes.data_as(double) for c in out))
        call = kernel.library.carom_collide_batch
        return call(ctypes.byref(p), friction, ctypes.c_size_t(count), pointers, places, status)

    for friction in (None, u_b):
        out = [np.full(n, 7.0) for _ in range(12)]
        status = np.full(n, 9, dtype=np.uint8)
        given = None if friction is None else friction.ctypes.data_as(double)
        good = run(given, n, status.ctypes.data_as(ctypes.c_char_p), out)
        assert good == int((status == OK).sum()) and status[5] == BAD_INPUT
        for i in range(n):
            u = 0.05 if friction is None else friction[i]
            params = (R, M, 0.2, 0.2, u, 0.95)
            code, one, two = kernel.collide(rows[i, 6:15], rows[i, 15:24], params)
            assert code == status[i]
            got, want = np.array([c[i] for c in out]), np.array([*one[3:], *two[3:]])
            if kernel.exact_bits:
                assert np.array_equal(got, want, equal_nan=True)
            elif code == OK:
                assert got == pytest.approx(want, rel=1e-9, abs=1e-9)
    unasked = [np.full(n, 7.0) for _ in range(12)]
    assert run(u_b.ctypes.data_as(double), n, None, unasked) == good
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(out, unasked, strict=True))
    untouched = [np.full(n, 7.0) for _ in range(12)]
    assert run(None, 0, None, untouched) == 0
    assert all((c == 7).all() for c in untouched)
    velocities = [columns[k] for k in (*range(3, 9), *range(12, 18))]
    assert run(u_b.ctypes.data_as(double), n, None, velocities) == good  # in place
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(out, velocities, strict=True))


def test_the_kernel_names_itself(kernel: Kernel) -> None:
    question = kernel.library.carom_kernel().decode().split(" ")[0]
    assert question.split("/")[3].startswith(f"{kernel.model}-")
