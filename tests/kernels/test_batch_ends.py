"""Batches of fixed steps end: each lane after as many steps as its own collision takes."""

from dataclasses import replace

import numpy as np
import pytest

from generator.emission.kernel_source import emit
from generator.errors import KernelError
from generator.impacts.ball_ball.evidence.fixed_steps import euler_verdict
from generator.registry.variant import fixed_steps, make_variant
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.build import build
from tests.support.kernels import CACHE, bench_tool, build_all, job_of
from tests.support.reference import load_reference

MODEL = "mathavan2014"
ROW = (0.028575, 0.170097, 0.2, 0.2, 0.0625, 1.0)  # R M u_s1 u_s2 u_b e_b
SCALAR = {
    "state": "reduced",
    "reuse": "factored",
    "order": "chain",
    "roots": "early",
    "branch": "chosen",
    "rsqrt": "ahead",
}
KERNELS = (
    ("x86-64-v2", 2, {"fma": "nofma", "lane_root": "est1", "finished": "aside"}),
    ("x86-64-v3", 4, {"fma": "nofma", "lane_root": "cubic", "interleave": "i4"}),
    ("x86-64-v3", 4, {"fma": "fma", "lane_root": "cubic", "finished": "refilled"}),
)


def _variant(target, width, steps, options):
    if not read_host().runs(find_target(target)):
        pytest.skip(f"{target} code does not run on this CPU")
    stepper = fixed_steps(steps)
    return make_variant(target, "any", MODEL, stepper, width, **{**SCALAR, **options})


def _head_on():
    """1 m/s along x, e_b = 1: N = 64: all numbers are exact, compression comes to v_n = 0."""
    row = np.zeros(24)
    row[:6] = ROW
    row[[8, 17]] = ROW[0]
    row[15] = 2 * ROW[0]
    row[9] = 1.0
    return row


@pytest.mark.parametrize("steps", [40, 64])
@pytest.mark.parametrize(
    ("target", "width", "options"), KERNELS, ids=lambda k: k["fma"] if isinstance(k, dict) else k
)
def test_compression_that_ends_at_zero_approach_ends_like_any_other(target, width, options, steps):
    """Once the number of steps left was NaN there: a lane, or all, went on for 1e9 steps."""
    [built] = build_all([_variant(target, width, steps, options)])
    assert not isinstance(built, KernelError), built
    tool, reference = bench_tool(), load_reference().cases.copy()
    reference = reference[reference[:, 0] == ROW[0]]
    reference[:, 1:4] = ROW[1:4]  # one batch: all parameters alike but u_b
    elastic = reference[(reference[:, 5] == 1) & (np.abs(reference[:, 18:24]).max(axis=1) == 0)]
    ties = np.vstack([_head_on(), elastic])
    euler = tool.expect(ties, "euler", MODEL, steps)
    exact = tool.expect(ties, "exact", MODEL)
    others = reference[:8].copy()
    others[:, 5] = ROW[5]
    alone = tool.run_kernel(built.path, others, batch=True, timeout=600.0)
    for place in range(9):  # each lane of the vectors
        rows = np.vstack([others[:place], ties, others[place:]])
        got = tool.run_kernel(built.path, rows, batch=True, timeout=600.0)
        here = slice(place, place + len(ties))
        verdict = euler_verdict(ties, got[here], euler, exact, steps, flip_share=1.0)
        assert verdict.passed, f"place {place}: {verdict.reason}"
        rest = np.delete(got, here, axis=0)
        assert np.array_equal(rest, alone), f"others differ where ties begin in place {place}"
    print(f"{len(ties)} ties in 9 places: {verdict.reason}")


DRIVE = "pace.drive = real("


@pytest.mark.parametrize("wrong", ["0.0 * ", '__builtin_nan("") * '], ids=["never", "nan"])
def test_a_lane_that_never_gets_there_ends_all_the_same(wrong):
    """v_n that does not rise, or is NaN: whatever goes wrong with numbers, steps are counted."""
    made = _variant("x86-64-v2", 2, 40, {"fma": "nofma"})
    source = emit(made)
    assert source.source.count(DRIVE) == 1
    spoilt = replace(source, source=source.source.replace(DRIVE, f"{DRIVE}{wrong}"))
    built = build(job_of(made, spoilt), CACHE)
    rows = np.vstack([_head_on(), load_reference().cases[:40]])
    rows[:, :6] = ROW
    got = bench_tool().run_kernel(built.path, rows, batch=True, timeout=600.0)
    want = bench_tool().expect(rows, "euler", MODEL, 40)
    off = np.nan_to_num(np.abs(got[:, :12] - want[:, :12]), nan=np.inf).max()
    print(f"{len(rows)} collisions ended, {off:.3g} m/s off")
    assert off > 0.01, "the kernel was not spoilt: this test shows nothing"
