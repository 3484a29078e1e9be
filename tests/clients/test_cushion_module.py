"""The installed module's cushion: kernels against the reference, objects, batches, refusals."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from tests.support.cushion import errors, load_cases, load_outcomes
from tests.support.installed import carom

R = 0.028575
ROLL = [[0, 1.0, 0], [-1.0 / R, 0, 0]]
FIELDS = ("R", "M", "u_s", "u_w", "e_c", "h")


@pytest.mark.parametrize("model", ["clamped", "printed"])
@pytest.mark.parametrize("budget", [1e-3, 1e-6, 1e-9])
def test_kernels_keep_their_budget_on_all_reference_cases(model: str, budget: float) -> None:
    cases, module = load_cases(), carom()
    want = load_outcomes("exact.csv", cases.ids)
    if model == "printed":
        lifts = load_outcomes("exact_printed.csv", cases.ids)
        want = np.where(np.isnan(lifts), want, lifts)
        tangent = np.tan(np.arcsin(cases.rows[:, 5] / cases.rows[:, 0] - 1))
        want[cases.rows[:, 3] > tangent] = np.nan  # there its answer need not be unique
    kernel, found = module.CushionKernel(model, max_error=budget), []
    for row in cases.rows:
        ball, status = kernel.collide(
            module.CushionParameters(*row[:6]), row[6:12].reshape(2, 3), row[12:]
        )
        assert status is module.Status.OK
        found.append(ball.ravel())
    off = errors(np.array(found), want, cases)
    off = off[np.isfinite(off)]
    print(f"{kernel.name}: {len(off)} cases, largest error {off.max():.1e}")
    assert len(off) > 300 and off.max() <= budget


def test_batches_of_any_layout_are_what_calls_give() -> None:
    module, cases = carom(), load_cases()
    rows = cases.rows[:200, 6:]
    p = module.CushionParameters()
    for kernel in (module.CushionKernel(), module.CushionKernel("pooltool", steps=300)):
        calls = [kernel.collide(p, row[:6].reshape(2, 3), row[6:]) for row in rows]
        want = np.array([ball.ravel() for ball, _ in calls])
        out, status = kernel.collide_batch(p, rows.T)
        assert out.shape == (6, 200) and status.tolist() == [int(s) for _, s in calls]
        turned, _ = kernel.collide_batch(p, rows)
        balls, marks = kernel.collide_batch(p, rows[:, :6].reshape(-1, 2, 3), rows[:, 6:])
        # Calls and batches are two units of one text, which a compiler may round differently; a
        # step of the scheme may then be one more or less.
        speed = np.linalg.norm(rows[:, :3], axis=1)
        off = (np.abs(out.T - want)[:, :3].max(axis=1) / speed).max()
        print(f"{kernel.name}: velocities of batch and calls differ by {off:.1e} of the speed")
        assert off <= 2e-6
        assert (turned == out.T).all() and (balls.reshape(-1, 6) == turned).all()
        assert (marks == status).all()
        alone = np.hstack([kernel.collide_batch(p, rows[n : n + 1].T)[0] for n in range(50)])
        assert (alone == out[:, :50]).all()


def test_a_batch_takes_a_friction_for_each_and_places_for_results() -> None:
    module = carom()
    kernel, p = module.CushionKernel(), module.CushionParameters()
    columns = np.tile([*ROLL[0], *ROLL[1], 0, 1], (3, 1)).T.copy()
    u_w = [0.0, 0.2, 0.9]
    out, status = np.empty((6, 3)), np.empty(3, dtype=np.uint8)
    told = kernel.collide_batch(p, columns, u_w=u_w, out=out, status=status)
    assert told[0] is out and told[1] is status and (status == 0).all()
    for friction, ball in zip(u_w, out.T, strict=True):
        want, _ = kernel.collide(p.replace(u_w=friction), ROLL, [0, 1])
        assert np.abs(ball - want.ravel()).max() < 1e-9 / R
    all_one, _ = kernel.collide_batch(p, columns, u_w=0.9)
    assert (all_one[:, 0] == out[:, 2]).all()
    print(f"v'/v with u_w .2: {-out[1, 1]:.9f}")
    assert out[1, 1] == pytest.approx(-0.8042818992213045, abs=1e-6)


def test_statuses_say_what_was_no_impact() -> None:
    module = carom()
    kernel, p = module.CushionKernel(), module.CushionParameters()
    ball, status = kernel.collide(p, ROLL, [0, -1])
    assert status is module.Status.SEPARATING and (ball == np.array(ROLL)).all()
    assert kernel.collide(p, ROLL, [0, 0])[1] is module.Status.BAD_INPUT
    assert kernel.collide(p, [[0, np.nan, 0], [0, 0, 0]], [0, 1])[1] is module.Status.BAD_INPUT


def test_parameters_and_kernels_compare_hash_copy_pickle_and_print() -> None:
    module = carom()
    names = {"CushionParameters": module.CushionParameters, "CushionKernel": module.CushionKernel}
    one = module.CushionParameters(u_w=0.14, h=0.04)
    kernel = module.CushionKernel("printed", max_error=1e-3)
    for first in (one, kernel, module.CushionKernel("pooltool", steps=300)):
        for again in (copy.copy(first), copy.deepcopy(first), pickle.loads(pickle.dumps(first))):
            assert again == first and hash(again) == hash(first) and again is not first
        assert eval(repr(first), names) == first
    assert one != module.CushionParameters() and one != 1 and kernel != module.CushionKernel()
    assert one.replace(u_w=0.2, h=0.036576) == module.CushionParameters()
    assert [getattr(module.CushionParameters(), name) for name in FIELDS][:2] == [R, 0.170097]
    with pytest.raises(AttributeError):
        one.u_w = 0.2


def test_what_cannot_be_is_named() -> None:
    module = carom()
    kernel, p = module.CushionKernel(), module.CushionParameters()
    for kind, words, call in (
        (ValueError, "u_w = 1.5 is out of range: expected 0 to 1", lambda: p.replace(u_w=1.5)),
        (ValueError, "h = 0.02 is out of range: expected R = 0.028575", lambda: p.replace(h=0.02)),
        (ValueError, "degrees; expected below 90", lambda: p.replace(u_s=1, u_w=1)),
        (TypeError, "e_c: expected a number; str came", lambda: p.replace(e_c="x")),
        (ValueError, "there are clamped", lambda: module.CushionKernel("mathavan2014")),
        (ValueError, "pooltool has fixed steps alone", lambda: module.CushionKernel("pooltool")),
        (ValueError, "no kernel is as exact", lambda: module.CushionKernel(max_error=1e-15)),
        (TypeError, "CushionParameters", lambda: kernel.collide(module.Parameters(), ROLL, [0, 1])),
        (TypeError, "normal: expected two numbers", lambda: kernel.collide(p, ROLL, [0, 1, 0])),
        (TypeError, "ball: expected numbers of shape", lambda: kernel.collide(p, ROLL[0], [0, 1])),
        (TypeError, "columns: expected", lambda: kernel.collide_batch(p, np.zeros((7, 9)))),
        (
            ValueError,
            "normals: expected as many",
            lambda: kernel.collide_batch(p, np.zeros((2, 2, 3)), np.zeros((3, 2))),
        ),
    ):
        with pytest.raises(kind, match=words) as caught:
            call()
        print(caught.value)
