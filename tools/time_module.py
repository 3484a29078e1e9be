"""Time of the Python module against C, interleaved: PYTHONPATH=. python tools/time_module.py

The C side is the same kernel in a library of its own, called once for all collisions.
"""

from __future__ import annotations

import ctypes
import sys
import time
from collections.abc import Callable

import numpy as np

from generator.emission.kernel_source import emit
from generator.registry.names import name_of, variant_of
from generator.registry.variant import Variant
from generator.targets.target import find_target
from generator.toolchain.build import build_library
from generator.toolchain.compilers import find_compilers
from generator.toolchain.flags import compile_flags
from tests.support.installed import BUILD, carom

COLLISIONS, ROUNDS = 1_000_000, 9
SINGLE, SHORT_ROUNDS = 50, 2000  # blocks so short that few are interrupted
R = 0.028575
GIVEN = (R, 0.170097, 0.2, 0.2, 0.05, 0.95)
Call = Callable[[], object]
Column = ctypes.POINTER(ctypes.c_double)


def shots(count: int, seed: int = 2014) -> np.ndarray:
    """Columns of balls that touch and approach: cue balls of 0.1 to 10 m/s with any spin."""
    rng = np.random.default_rng(seed)
    balls = np.zeros((18, count))
    angle, cut = rng.uniform(0, 2 * np.pi, count), rng.uniform(-1.5, 1.5, count)
    speed = 10 ** rng.uniform(-1, 1, count)
    balls[[2, 11]] = R
    balls[3:5] = speed * np.array([np.cos(angle + cut), np.sin(angle + cut)])
    balls[6:9] = rng.normal(size=(3, count)) * 0.5 * speed / R
    balls[9:11] = 2 * R * np.array([np.cos(angle), np.sin(angle)])
    return balls


def variant_in(kernel) -> Variant:  # type: ignore[no-untyped-def]
    """The variant that a kernel of the module is made from; the module is built by GCC."""
    return variant_of(kernel.name)


def c_batch(variant: Variant, balls: np.ndarray, out: np.ndarray) -> Call:
    """A call of the kernel's batch function in a library of its own, pointers ready."""
    compiler = next(c for c in find_compilers() if c.code == "gcc")
    source = emit(variant)
    texts = {"carom.h": source.header, "kernel.cpp": source.source, "probe.cpp": source.probe}
    flags = compile_flags(variant, compiler, find_target(variant.target))
    library = ctypes.CDLL(str(build_library(texts, (), compiler, flags, BUILD / "kernels").path))
    columns = [array.ctypes.data_as(Column) for array in (*balls, *out)]
    numbers = (ctypes.c_double * 6)(*GIVEN)
    places = (Column * 18)(*columns[:18]), (Column * 12)(*columns[18:])
    status = np.empty(balls.shape[1], np.uint8)
    pointer = status.ctypes.data_as(ctypes.c_char_p)
    count = ctypes.c_size_t(balls.shape[1])

    def call() -> object:
        assert len(balls) == 18 and len(out) == 12  # held here: C has their addresses alone
        return library.carom_probe_batch(numbers, None, count, *places, pointer)

    return call


def seconds(call: Call) -> float:
    begun = time.perf_counter()
    call()
    return time.perf_counter() - begun


def compare(rounds: int, *calls: Call) -> np.ndarray:
    """Seconds of each call in rows of rounds, in alternating order; the first round is not kept."""
    table = []
    for number in range(rounds + 1):
        order = range(len(calls)) if number % 2 else range(len(calls) - 1, -1, -1)
        taken = {index: seconds(calls[index]) for index in order}
        table.append([taken[index] for index in range(len(calls))])
    return np.array(table[1:])


def batch_speeds(goal: dict[str, float], collisions: int) -> np.ndarray:
    """Print a batch's times; speeds of the ways of calling it, in those of C."""
    kernel, parameters = carom().Kernel(**goal), carom().Parameters(*GIVEN)
    balls, out = shots(collisions), np.empty((12, collisions))
    status, rows = np.empty(collisions, np.uint8), balls.T.copy()
    plain = np.empty((12, collisions))
    table = compare(
        ROUNDS,
        c_batch(variant_in(kernel), balls, plain),
        lambda: kernel.collide_batch(parameters, balls, out=out, status=status),
        lambda: kernel.collide_batch(parameters, balls),
        lambda: kernel.collide_batch(parameters, rows.T),
    )
    assert np.array_equal(out, plain), "other results than C"
    print(f"{kernel.name}, {collisions} collisions")
    names = ("C", "NumPy, arrays given", "NumPy, arrays made", "NumPy, rows of an (n, 18) array")
    speeds = np.median(table[:, :1] / table, axis=0)
    for name, taken, speed in zip(names, np.median(table, axis=0), speeds, strict=True):
        print(
            f"  {name:32} {taken / collisions * 1e9:7.1f} ns a collision  {speed:.3f} of C's speed"
        )
    return speeds


def over_the_kernel() -> float:
    """Seconds of one call from Python beyond those of a scalar kernel, printed."""
    kernel, parameters = carom().Kernel(max_error=1e-6), carom().Parameters(*GIVEN)
    some = shots(SINGLE)
    pairs = [(b[:9].reshape(3, 3).copy(), b[9:].reshape(3, 3).copy()) for b in some.T]
    out1, out2 = np.empty((3, 3)), np.empty((3, 3))

    def each() -> None:
        for one, two in pairs:
            kernel.collide(parameters, one, two)

    def each_into() -> None:
        for one, two in pairs:
            kernel.collide_into(parameters, one, two, out1, out2)

    def loop() -> None:
        for _pair in pairs:
            pass

    scalar = variant_in(kernel).in_lanes(1)
    kernels = c_batch(scalar, some, np.empty((12, SINGLE)))
    table = compare(SHORT_ROUNDS, kernels, each, each_into, loop)
    over = np.median(table[:, 1:3] - table[:, :1] - table[:, 3:], axis=0) / SINGLE
    print(f"one call over {name_of(scalar)}: collide {over[0] * 1e9:.0f} ns, ", end="")
    print(f"collide_into {over[1] * 1e9:.0f} ns")
    return float(over[0])


def main() -> int:
    """Print the figures; 1 where they are not what docs/measurements.md says of them."""
    exact = batch_speeds({"max_error": 1e-6}, COLLISIONS)
    fixed = batch_speeds({"steps": 1000}, COLLISIONS)
    over = over_the_kernel()
    return int(over > 2e-6 or min(exact[1:3].min(), fixed[1:3].min()) < 0.9)


if __name__ == "__main__":
    sys.exit(main())
