"""Degenerate input: every kind ends in bounded time with the documented status, and no NaN."""

from __future__ import annotations

import resource
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest

from generator.evidence.timing.bench_tool import BenchTool, Way
from generator.evidence.verification.errors import Array
from generator.impacts.ball_ball.evidence.measure import CASE_NAMES, STATUS
from tests.support.exact_kernels import (
    MODELS,
    M,
    R,
    Worst,
    built,
    exact_variant,
    fixed_step_variant,
    hexfloats,
)
from tests.support.kernels import bench_tool
from tests.support.reference import load_reference

OK, SEPARATING, BAD_INPUT, TILTED = range(4)
FAST, LONG = 20_000, 1_000_000
SLOWEST = {"exact": 20e-6, "fixed": 1e-3}  # seconds a collision; with denormals steps are slow
CHUNK = 50_000
Kind = Callable[[np.random.Generator, int, str], tuple[Array, Array]]


def at(*names: str) -> list[int]:
    return [CASE_NAMES.index(name) for name in names]


V1, W1 = at("v1x", "v1y", "v1z"), at("w1x", "w1y", "w1z")
V2, W2 = at("v2x", "v2y", "v2z"), at("w2x", "w2y", "w2z")
R1, R2 = at("r1x", "r1y", "r1z"), at("r2x", "r2y", "r2z")
MOTIONS = [*V1, *W1, *V2, *W2]
SPINS = [*W1, *W2]


def plain(rng: np.random.Generator, n: int) -> Array:
    """Ordinary approaching shots, in all directions, both balls moving and spinning."""
    rows = np.zeros((n, 24))
    rows[:, :6] = (R, M, 0.2, 0.3, 0.05, 0.95)
    angle = rng.uniform(-np.pi, np.pi, n)
    f = np.column_stack([np.cos(angle), np.sin(angle)])
    rows[:, R1[:2]] = rng.uniform(0, 2, (n, 2))
    rows[:, R2[:2]] = rows[:, R1[:2]] + 2 * R * f
    rows[:, [R1[2], R2[2]]] = R
    rows[:, V1[:2]] = rng.uniform(0.2, 3, (n, 1)) * f + rng.uniform(-0.1, 0.1, (n, 2))
    rows[:, V2[:2]] = rng.uniform(-0.1, 0.02, (n, 1)) * f
    rows[:, W1] = rng.uniform(-60, 60, (n, 3))
    rows[:, W2] = rng.uniform(-60, 60, (n, 3)) * rng.integers(0, 2, (n, 1))
    return rows


def along_axis(rng: np.random.Generator, n: int) -> tuple[Array, Array, Array]:
    """Shots along +-x or +-y, without rounding in the frame: rows, axis (0 or 1) and sign."""
    rows, axis, sign = plain(rng, n), rng.integers(0, 2, n), rng.choice([-1.0, 1.0], n)
    i = np.arange(n)
    rows[:, [*R1[:2], *R2[:2]]] = 0.0
    rows[i, np.array(R2)[axis]] = sign * 2 * R
    rows[:, [*V1, *V2]] = 0.0
    rows[i, np.array(V1)[1 - axis]] = rng.uniform(-2, 2, n)
    rows[i, np.array(V2)[1 - axis]] = rng.uniform(-2, 2, n) * rng.integers(0, 2, n)
    return rows, axis, sign


def statuses(n: int, status: int) -> Array:
    return np.full(n, float(status))


def zero(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    """Not approaching at all: along an axis, or the same velocity in any direction."""
    rows, axis, _ = along_axis(rng, n)
    i, common = np.arange(n), rng.uniform(-3, 3, n) * rng.integers(0, 2, n)
    rows[i, np.array(V1)[axis]] = rows[i, np.array(V2)[axis]] = common
    same = plain(rng, n // 2)
    same[:, V2] = same[:, V1]
    rows[: n // 2] = same
    return rows, statuses(n, SEPARATING)


def tiny(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    """Approaching by 1e-13 of the speed, down to a denormal, or by one rounding of it."""
    rows, axis, sign = along_axis(rng, n)
    i = np.arange(n)
    decades = np.where(rng.random(n) < 0.5, rng.uniform(-20, -13, n), rng.uniform(-323.3, -20, n))
    rows[i, np.array(V1)[axis]] = sign * np.maximum(10.0**decades, 5e-324)
    third = np.arange(n // 3)
    common = sign[third] * rng.uniform(0.1, 5, n // 3)
    rows[third, np.array(V2)[axis[third]]] = common
    rows[third, np.array(V1)[axis[third]]] = np.nextafter(common, sign[third] * np.inf)
    return rows, statuses(n, OK)


def positive(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    rows = plain(rng, n)
    rows[:, [*V1, *V2]] *= -1
    axial, axis, sign = along_axis(rng, n // 2)
    decades = rng.uniform(-323.3, 2, n // 2)
    axial[np.arange(n // 2), np.array(V2)[axis]] = sign * np.maximum(10.0**decades, 5e-324)
    rows[: n // 2] = axial
    return rows, statuses(n, SEPARATING)


def coincident(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    rows = plain(rng, n)
    rows[:, R2] = rows[:, R1]
    apart = np.arange(0, n, 2)  # or as near as makes no direction
    rows[np.ix_(apart, [*R1, *R2])] = 0.0
    rows[apart, R2[0]] = 10.0 ** rng.uniform(-323, -151, len(apart))
    return rows, statuses(n, BAD_INPUT)


def not_finite(rng: np.random.Generator, n: int, model: str, values: tuple[float, ...] = ()):
    rows = plain(rng, n)
    rows[np.arange(n), np.arange(n) % 24] = rng.choice(values, n)
    return rows, statuses(n, BAD_INPUT)


def denormal_speeds(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    """Every speed denormal; what comes of it is at most a few denormals."""
    rows = plain(rng, n)
    rows[:, MOTIONS] = rng.integers(-1000, 1000, (n, 12)) * 5e-324
    rows[:, [V1[2], V2[2]]] = 0.0
    return rows, statuses(n, -1)  # OK or SEPARATING, by rounding


def denormal_parameters(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    rows, which = plain(rng, n), np.arange(n) % 6
    rows[np.arange(n), which] = rng.integers(1, 1 << 40, n) * 5e-324
    return rows, np.where(which < 2, BAD_INPUT, OK).astype(float)


def denormal_all(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    rows = rng.integers(1, 1 << 40, (n, 24)) * 5e-324
    return rows, statuses(n, BAD_INPUT)


def tilted(rng: np.random.Generator, n: int, model: str, low: float = -6, high: float = -1):
    rows = plain(rng, n)
    rise = 10.0 ** rng.uniform(low + 0.01, high, n) * rng.choice([-1.0, 1.0], n)
    rows[:, [*R1, *R2]] -= np.tile(rows[:, R1], 2)
    rows[:, R2[2]] = 2 * R * rise
    return rows, statuses(n, -1 if model == "pooltool" else TILTED)


def hardly_tilted(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    rows, _ = tilted(rng, n, model, low=-12, high=-6.01)
    return rows, statuses(n, OK)


def in_float32(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    """Positions that went through a float32, one ball's or both, up to 1 km from the origin."""
    rows = plain(rng, n)
    away = 10.0 ** rng.uniform(-3, 3, (n, 2)) * rng.choice([-1.0, 1.0], (n, 2))
    rows[:, [*R1[:2], *R2[:2]]] += np.tile(away, 2)
    one, both = np.arange(0, n, 2), np.arange(1, n, 2)
    rows[np.ix_(one, R1)] = rows[np.ix_(one, R1)].astype(np.float32)
    rows[np.ix_(both, [*R1, *R2])] = rows[np.ix_(both, [*R1, *R2])].astype(np.float32)
    return rows, statuses(n, OK)


def vertical(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    rows = plain(rng, n)
    rows[:, R2] = rows[:, R1]
    rows[:, R2[2]] += R * rng.uniform(0.1, 3, n) * rng.choice([-1.0, 1.0], n)
    rows[:, [V1[2], V2[2]]] = rng.uniform(-1, 1, (n, 2))
    return rows, statuses(n, -1 if model == "pooltool" else TILTED)


def spaced(rng: np.random.Generator, n: int, model: str, low: float = 0, high: float = 0):
    """Centres at 10^low to 10^high diameters: only the direction counts."""
    rows = plain(rng, n)
    d = rows[:, R2] - rows[:, R1]
    rows[:, R1] = 0.0
    rows[:, R2] = d * 10.0 ** rng.uniform(low, high, (n, 1))
    return rows, statuses(n, OK)


def scaled(rng: np.random.Generator, n: int, model: str, low: float = 0, high: float = 0):
    rows = plain(rng, n)
    decades = rng.uniform(low, high, (n, 1))
    rows[:, MOTIONS] /= np.abs(rows[:, MOTIONS] * np.where(np.isin(MOTIONS, SPINS), R, 1)).max(
        axis=1, keepdims=True
    )
    rows[:, MOTIONS] *= 10.0**decades
    return rows, statuses(n, BAD_INPUT if low >= 100 else OK)


def spun(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    """Slow shots along y, a ball pressed, that spin about y: table slip beyond all measure."""
    rows = np.zeros((n, 24))
    rows[:, :6] = plain(rng, n)[:, :6]
    rows[:, R2[1]] = 2 * R
    rows[:, [R1[2], R2[2]]] = R
    approach = 10.0 ** rng.uniform(-290, -40, n)
    rows[:, V1[1]] = approach
    rows[:, V1[0]] = approach * rng.choice([-1.0, 0.0, 0.3], n)
    rows[:, W1[0]] = approach / R * 10.0 ** rng.uniform(-3, 3, n) * rng.choice([-1.0, 1.0], n)
    spins = 10.0 ** rng.uniform(30, 98, (n, 2))
    rows[:, [W1[1], W2[1]]] = spins * rng.choice([-1.0, 1.0], (n, 2))
    return rows, statuses(n, OK)


def out_of_range(rng: np.random.Generator, n: int, model: str) -> tuple[Array, Array]:
    rows, which = plain(rng, n), np.arange(n) % 6
    low = np.where(which < 2, rng.choice([0.0, 1e-300], n), -(10.0 ** rng.uniform(-300, 2, n)))
    high = 1 + 10.0 ** rng.uniform(-15, 2, n)
    out = np.where((which < 2) | (rng.random(n) < 0.5), low, high)
    rows[np.arange(n), which] = out
    return rows, statuses(n, BAD_INPUT)


KINDS: dict[str, Kind] = {
    "v_n zero": zero,
    "v_n tiny": tiny,
    "v_n positive": positive,
    "coincident": coincident,
    "NaN": partial(not_finite, values=(np.nan, -np.nan)),
    "infinite": partial(not_finite, values=(np.inf, -np.inf)),
    "denormal speeds": denormal_speeds,
    "denormal parameters": denormal_parameters,
    "denormal everything": denormal_all,
    "tilted": tilted,
    "hardly tilted": hardly_tilted,
    "positions in float32": in_float32,
    "vertical": vertical,
    "overlapping": partial(spaced, low=-9, high=0),
    "gap": partial(spaced, low=0, high=12),
    "speeds 1e-300 to 1e-6": partial(scaled, low=-300, high=-6),
    "speeds to 1e99": partial(scaled, low=2, high=99),
    "speeds above 1e100": partial(scaled, low=100.01, high=300),
    "parameters out of range": out_of_range,
    "spun about the line of centres": spun,
}


@dataclass(frozen=True)
class Kernel:
    family: str  # "exact" or "fixed"
    model: str
    tool: BenchTool
    library: object

    def run(self, rows: Array, batch: bool, in_place: bool) -> Array:
        limit = 600 + SLOWEST[self.family] * len(rows)  # on a busy machine too
        return self.tool.run_kernel(
            self.library, rows, batch=batch, timeout=limit, way=Way(in_place)
        )


def _kernels(family: str) -> list[Kernel]:
    tool = bench_tool()
    make = fixed_step_variant if family == "fixed" else partial(exact_variant, budget=1e-6)
    libraries = built([make(model) for model in MODELS])
    return [Kernel(family, m, tool, path) for m, path in zip(MODELS, libraries, strict=True)]


@pytest.fixture(
    scope="module",
    params=[(f, m) for f in ("exact", "fixed") for m in MODELS],
    ids=lambda p: "-".join(p),
)
def kernel(request: pytest.FixtureRequest) -> Kernel:
    family, model = request.param
    return next(k for k in _kernels(family) if k.model == model)


def check(kernel: Kernel, kind: str, rows: Array, want: Array, got: Array) -> None:
    """The status is as documented; velocities are finite, or as they came to the last bit."""

    def demand(bad: Array, what: str) -> None:
        count = int(bad.sum())
        i = int(bad.argmax())
        assert not count, (
            f"{kind}, {kernel.family} {kernel.model}: {count} of {len(rows)} {what}: status "
            f"{got[i, STATUS]:g} for {want[i]:g}\n{hexfloats(rows[i])}\n{got[i]}"
        )

    status = got[:, STATUS]
    either = (want < 0) & ((status == OK) | (status == SEPARATING) | (status == BAD_INPUT))
    demand(~((status == want) | either), "with another status")
    came = np.ascontiguousarray(rows[:, MOTIONS]).view(np.uint64)
    gone = np.ascontiguousarray(got[:, :12]).view(np.uint64)
    demand((status != OK) & (came != gone).any(axis=1), "not as they came")
    demand((status == OK) & ~np.isfinite(got[:, :12]).all(axis=1), "not finite")
    most = np.abs(rows[:, MOTIONS] * np.where(np.isin(MOTIONS, SPINS), R, 1)).max(axis=1)
    now = np.abs(got[:, :12] * np.where(np.isin(MOTIONS, SPINS), R, 1)).max(axis=1)
    with np.errstate(invalid="ignore", over="ignore"):
        demand((status == OK) & ~(now <= 4 * most + 1e-320), "faster than they came")
    if kind == "v_n tiny":
        weight = np.where(np.isin(MOTIONS, SPINS), R, 1)
        change = np.abs((got[:, :12] - rows[:, MOTIONS]) * weight).max(axis=1)
        demand(~(change <= 1e-12 * most), "changed by more than such an approach can")


COLLIDE = {  # kinds that run a thousand fixed steps, of denormals even 200 us: a tenth of them
    *("v_n tiny", "denormal speeds", "denormal parameters", "hardly tilted", "overlapping", "gap"),
    *("positions in float32", "speeds 1e-300 to 1e-6", "speeds to 1e99", "tilted", "vertical"),
    "spun about the line of centres",
}


def all_kinds(kernel: Kernel, count: int) -> None:
    failed = []
    for number, kind in enumerate(KINDS):
        try:
            fewer = kernel.family == "fixed" and kind in COLLIDE
            one_kind(kernel, kind, number, count // 10 if fewer else count)
        except AssertionError as error:
            failed.append(str(error))
            print(f"{kernel.family} {kernel.model}, {kind}: FAILED")
    assert not failed, "\n".join(failed)


def cpu_seconds() -> float:
    """Of processes that have ended, this one's children: other work on the machine is not in it."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def one_kind(kernel: Kernel, kind: str, number: int, count: int) -> None:
    make, took, done = KINDS[kind], 0.0, 0
    while done < count:
        n = min(CHUNK, count - done)
        rng = np.random.default_rng([20141, number, done])
        rows, want = make(rng, n, kernel.model)
        outcomes = []
        for batch in (False, True):
            start = cpu_seconds()
            outcomes.append(kernel.run(rows, batch, in_place=bool(rng.integers(0, 2))))
            took += cpu_seconds() - start
            check(kernel, kind, rows, want, outcomes[-1])
        one, two = (np.ascontiguousarray(o).view(np.uint64) for o in outcomes)
        same = (one == two).all(axis=1)
        assert same.all(), f"{kind}: batch differs\n{hexfloats(rows[int(same.argmin())])}"
        done += n
    print(f"{kernel.family} {kernel.model}, {kind}: {count}, {1e6 * took / count / 2:.2f} us")
    assert took <= 30 + 2 * SLOWEST[kernel.family] * count


def test_degenerate_kinds(kernel: Kernel) -> None:
    all_kinds(kernel, FAST)


@pytest.mark.long
def test_a_million_of_each_degenerate_kind(kernel: Kernel) -> None:
    all_kinds(kernel, LONG)


def test_only_the_direction_of_the_line_of_centres_counts(kernel: Kernel) -> None:
    rng = np.random.default_rng(7)
    rows = plain(rng, 2000)
    rows[:, R2] -= rows[:, R1]
    rows[:, R1] = 0.0
    near = kernel.run(rows, False, False)
    for factor in (2.0**-20, 0.5, 2.0**30):  # exact, so nothing rounds
        moved = rows.copy()
        moved[:, R2] *= factor
        assert np.array_equal(kernel.run(moved, False, False), near)


def test_the_limit_of_tilt(kernel: Kernel) -> None:
    """A rise of up to 1e-6 counts as level, more is refused; pooltool's model takes any."""
    rng = np.random.default_rng(8)
    rows = plain(rng, 1000)
    rows[:, [*R1, *R2]] -= np.tile(rows[:, R1], 2)
    level = np.hypot(rows[:, R2[0]], rows[:, R2[1]])
    for rise, status in ((0.999e-6, OK), (1.001e-6, TILTED), (1e-3, TILTED)):
        rows[:, R2[2]] = rise * level
        got = kernel.run(rows, False, False)[:, STATUS]
        want = OK if kernel.model == "pooltool" else status
        assert (got == want).all(), (rise, set(got))


def test_positions_in_float32_collide_along_their_level_direction(kernel: Kernel) -> None:
    """Heights that a float32 rounded are no slope: the result is that of the projected line."""
    rng = np.random.default_rng(9)
    cases = np.vstack([load_reference().cases, in_float32(rng, 4000, kernel.model)[0]])
    cases[:, R1] = cases[:, R1].astype(np.float32)
    rise = np.abs(cases[:, R2[2]] - cases[:, R1[2]])
    length = np.linalg.norm(cases[:, R2] - cases[:, R1], axis=1)
    cases = cases[(length > 0) & (rise <= 0.999e-6 * length)]
    level = cases.copy()
    if kernel.model != "pooltool":  # which takes the line as it rises
        level[:, R2[2]] = level[:, R1[2]]
    want = kernel.tool.expect(level, "exact", kernel.model)
    got = [kernel.run(cases, batch, False) for batch in (False, True)]
    assert np.array_equal(got[0][:, STATUS], want[:, STATUS])
    assert np.array_equal(got[0], got[1])
    if kernel.family == "exact":
        worst = Worst(1e-6)
        worst.add(cases, ["float32"] * len(cases), got[0], want)
        rising = int((rise > 1e-9 * length).sum())
        print(f"{len(cases)} cases, {rising} of them with a slope above 1e-9: {worst.error:.2g}")
        assert worst.passed, worst.line()
