"""The search for the largest error of a kernel: what it is made of, and what it finds."""

from __future__ import annotations

import csv
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from generator.choice import sought
from generator.choice.choose import Choice
from generator.choice.kernel import Rejected
from generator.errors import KernelError
from generator.evidence.challenge.hunts import asymmetry, growth, jumps
from generator.evidence.challenge.kept import csv_row
from generator.evidence.challenge.search import (
    Limits,
    Subject,
    counts_as_over,
    errors_confirmed,
    search,
)
from generator.evidence.timing.bench_tool import ROOT
from generator.evidence.verification.errors import Array
from generator.impacts.ball_ball.evidence import MODELS
from generator.impacts.ball_ball.evidence.measure import CASE_NAMES
from generator.impacts.ball_ball.evidence.scene_cases import contact_slip
from generator.impacts.ball_ball.scene import find_scene
from generator.impacts.ball_ball.search import rewind as rewinding
from generator.impacts.ball_ball.search.balls import cases_of
from generator.impacts.ball_ball.search.charts import (
    Layout,
    States,
    draw_chart,
    places_of,
    states_of,
)
from generator.impacts.ball_ball.search.envelope import Envelope, envelope
from tests.support.kernels import bench_tool
from tests.support.reference import keep, load_hard

BUDGET = 1e-6
FLAW = 5e-6  # of tests/evidence/planted.cpp
ADVERSARIAL = ROOT / "tests" / "data" / "adversarial"


def place(model: str = "mathavan2014") -> Envelope:
    return envelope(find_scene("any"), model, "scene")


@pytest.fixture(scope="module")
def planted(tmp_path_factory: pytest.TempPathFactory) -> Subject:
    """A kernel that is exact but for a corner: u_b > .5, u_s > .8, e_b from 1e-3 to 1.3e-3."""
    library = tmp_path_factory.mktemp("planted") / "planted.so"
    source = Path(__file__).with_name("planted.cpp")
    words = ["g++", "-std=c++17", "-O2", "-ffp-contract=off", "-shared", "-fPIC"]
    include = f"-I{ROOT / 'tests' / 'oracle' / 'ball_ball'}"
    subprocess.run([*words, include, str(source), "-o", str(library)], check=True)
    return Subject(bench_tool(), library, place(), BUDGET, batch=False)


# -- what it is made of --


def test_collisions_run_backward_meet_the_place_again() -> None:
    """Without friction the way back is known; with it, two halves of the way are the whole."""
    n, rng = 200, np.random.default_rng(1)
    at = np.zeros((5, n))
    at[:4] = rng.normal(size=(4, n)) * 10.0 ** rng.uniform(-10, 0, (1, n))
    at[1] = -np.abs(at[1])
    v_n, low = rng.uniform(-0.9, 0.9, n), np.full(n, -1.0)
    none = np.zeros(n)
    free = rewinding.rewind("mathavan2014", at, v_n, low, none, none)
    straight = np.abs(free[rewinding.S_Y] - (at[rewinding.S_Y] - (v_n + 1) / 2)).max()
    rubs = (np.full(n, 0.3), np.full(n, 0.5))
    far = rewinding.rewind("bottom_slip", at, v_n, low, *rubs)
    half = (v_n + low) / 2
    by_halves = rewinding.rewind("bottom_slip", at, v_n, half, *rubs)
    by_halves = rewinding.rewind("bottom_slip", by_halves, half, low, *rubs)
    apart = np.abs(far[:4] - by_halves[:4]).max()
    print(f"straight path off by {straight:.1e}, two halves of the way by {apart:.1e}")
    assert straight < 1e-13
    assert apart < 1e-7


@pytest.mark.parametrize("model", MODELS)
def test_cases_have_the_slips_that_were_wanted(model: str) -> None:
    n, rng = 500, np.random.default_rng(2)
    slips = rng.normal(size=(4, n)) * 10.0 ** rng.uniform(-6, 1, (4, n))
    slips[1] = -np.abs(slips[1])
    states = States(slips, np.full(n, 0.1), np.full(n, 0.2), np.full(n, 0.9))
    for layout in (Layout(False, 0.0, 0.0, False, 1.0), Layout(True, 1.0, 0.5, True, 3.0)):
        cases = cases_of(states, layout, place(model))
        size = np.maximum(np.abs(slips).max(axis=0), 1)
        off = np.abs(contact_slip(cases, model) / layout.speed - np.hypot(slips[0], slips[1]))
        print(f"{model}: contact slip off by {(off / size).max():.1e} of the fastest speed")
        assert (off / size).max() < 8e-16


def test_charts_stay_within_the_documented_ranges() -> None:
    rng, within = np.random.default_rng(3), place()
    for _ in range(60):
        chart = draw_chart(rng, within)
        genes = rng.uniform(-0.5, 1.5, (50, 8))
        cases = cases_of(states_of([places_of(chart, genes)], within)[0], chart.layout, within)
        cases = cases[np.isfinite(cases).all(axis=1)]
        for column, (low, high) in ((2, within.u_s), (4, within.u_b), (5, within.e_b)):
            assert ((cases[:, column] >= low) & (cases[:, column] <= high)).all(), chart


# -- what it finds --


def test_search_finds_a_planted_flaw_that_random_cases_miss(planted: Subject) -> None:
    random = planted.tool.make_cases(1, 5000, mixed=False).rows
    beyond = (planted.judge().answers(random).over > 1).sum()
    found = search(planted, Limits(12_000), seed=1)
    print(f"random cases over: {beyond}; search: {found.worst.over:.3g} of the budget")
    assert beyond == 0
    assert not found.held
    assert found.worst.over == pytest.approx(FLAW / BUDGET, rel=0.01)
    assert found.worst.moved < BUDGET


def test_search_finds_the_same_again(planted: Subject) -> None:
    """Over several generations of every strategy: two rounds of each lane go by at random."""
    first, second = (search(planted, Limits(15_000), seed=7) for _ in range(2))
    assert csv_row("", first.worst.case) == csv_row("", second.worst.case)
    assert first.evaluations == second.evaluations


def flawed(e_b: float) -> Array:
    """A case with the planted flaw if e_b is between 1e-3 and 1.3e-3."""
    slips = np.array([[0.6], [-0.9], [0.3], [0.4]])
    one = np.ones(1)
    states = States(slips, 0.55 * one, 0.9 * one, e_b * one)
    return cases_of(states, Layout(False, 0.0, 0.0, False, 1.0), place())


def test_a_hunt_whose_time_is_over_still_tells_of_one_round(planted: Subject) -> None:
    """A short search of a large kernel leaves its last hunts no time."""
    found = search(planted, Limits(12_000, time.monotonic() - 1), 1, "symmetry")
    print(f"{found.evaluations} evaluations, worst {found.worst.over:.2g} of the budget")
    assert 0 < found.evaluations < 12_000 and np.isfinite(found.worst.over)


def test_jump_is_found_between_two_neighbouring_doubles(planted: Subject) -> None:
    at, over = jumps(planted.judge(), flawed(1e-3 * (1 + 1e-6)))
    print(f"jump of {over[0] / 10:.3g} budgets at e_b = {at[0, 5]!r}")
    assert over[0] == pytest.approx(10 * FLAW / BUDGET, rel=0.01)
    assert at[0, 5] == pytest.approx(1e-3, rel=1e-12)


def test_symmetry_and_energy_are_looked_at(planted: Subject) -> None:
    """The flaw adds to v_x of ball 1 whatever its direction: no image of the case agrees."""
    cases = np.concatenate([flawed(1.1e-3), flawed(2e-3)])
    images, energy = asymmetry(planted.judge(), cases), growth(planted.judge(), cases)
    print(f"images differ by {images}, energy grows by {energy} of the budget")
    assert images[0] > 1 > images[1]
    assert (energy < 0).all()


def test_roundings_are_told_apart(planted: Subject) -> None:
    """Where balls are 1e12 times as fast as they approach, doubles say no more."""
    cases = flawed(0.5)
    cases[:, [9, 18]] += 2.0**40
    (finding,) = errors_confirmed(planted.judge(), cases)
    print(f"{finding.kind}: {finding.over:.3g} of the budget")
    assert finding.over > 1
    assert not counts_as_over(finding)


# -- what follows from it --


@dataclass(frozen=True)
class FakeCandidate:
    name: str


class FakeVerifier:
    def verify_at_worst(self, kernel: FakeCandidate) -> FakeCandidate:
        return kernel


def said(over: float, known: bool = False) -> sought.Sought:
    case = csv_row("x", flawed(0.5)[0])
    return sought.Sought(100, 1, over, over <= 1, case, known=known)


def choosing(monkeypatch: pytest.MonkeyPatch, told: dict[str, sought.Sought]) -> Choice:
    """The choice among candidates of which a search says what `told` does."""
    candidates = [FakeCandidate(name) for name in told]

    def choose(kernels: sought.Entries) -> tuple[sought.Entries, Choice]:
        left = [c for c in kernels if not isinstance(c, Rejected)]
        if not left:
            raise KernelError("no candidate passed verification")
        return kernels, Choice(left[0], (), "default", "", "")

    def found(_bench: object, candidate: FakeCandidate, _known: object) -> sought.Sought:
        return told[candidate.name]

    monkeypatch.setattr(sought, "sought", found)
    bench = SimpleNamespace(verifier=FakeVerifier())
    kernels, choice = sought.choose_sought(bench, candidates, choose)  # type: ignore[arg-type]
    assert any(kernel is choice.chosen for kernel in kernels)
    print(f"chosen: {choice.chosen.name}")
    return choice


def test_kernel_that_the_search_breaks_is_not_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    choice = choosing(monkeypatch, {"fast": said(7.0), "slower": said(0.5)})
    assert choice.chosen.name == "slower"
    assert choice.sought == "0.5 of the budget, 100 evaluations, seed 1"


def test_search_goes_on_until_a_kernel_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    """The fourth of four: the main job once chose the first of three that were over."""
    told = {"fast": said(7.0), "slower": said(3.0), "slow": said(2.0), "doubles": said(0.5)}
    assert choosing(monkeypatch, told).chosen.name == "doubles"


def test_known_cases_cost_no_search(monkeypatch: pytest.MonkeyPatch) -> None:
    many = {f"known {n}": said(7.0, known=True) for n in range(3 * sought.SEARCHES)}
    told = {"fast": said(7.0), **many, "doubles": said(0.5)}
    assert choosing(monkeypatch, told).chosen.name == "doubles"


def test_a_choice_takes_so_many_searches_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    over = {f"over {n}": said(9.0 - n / 10) for n in range(sought.SEARCHES)}
    choice = choosing(monkeypatch, {**over, "never asked": said(0.5)})
    assert choice.chosen.name == f"over {sought.SEARCHES - 1}"


def test_where_none_holds_the_least_over_of_those_searched_stands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = {"fast": said(3.0), "less": said(1.5), "known": said(1.01, known=True)}
    choice = choosing(monkeypatch, told)
    assert choice.chosen.name == "less"
    assert choice.sought is not None
    assert choice.sought.startswith("OVER: 1.5 of the budget")
    assert "; case 0,x," in choice.sought


def test_found_cases_are_kept_once_and_to_the_last_bit(tmp_path: Path) -> None:
    path = tmp_path / "hard.csv"
    path.write_text(
        ",".join(["kind", *CASE_NAMES]) + "\n" + "a," + ",".join(["0x0.0p+0"] * 24) + "\n"
    )
    case = flawed(1 / 3)[0]
    assert keep([("found_by_search", case)], path) == 1
    assert keep([("found_by_search", case)], path) == 0
    kinds, rows = load_hard(path)
    assert kinds == ("a", "found_by_search")
    assert (rows[1] == case).all()


@pytest.mark.parametrize("model", MODELS)
def test_adversarial_inputs_are_not_steep(model: str) -> None:
    """A rounding of them is no excuse: it moves their exact results by less than any budget."""
    with (ADVERSARIAL / f"inputs_{model}.csv").open(newline="") as file:
        rows = np.array([[float(r[name]) for name in CASE_NAMES] for r in csv.DictReader(file)])
    judge = Subject(bench_tool(), Path(), place(model), BUDGET, batch=False).judge()
    moved = max(judge.moved(row) for row in rows)
    print(f"{model}: {len(rows)} inputs, moved by at most {moved:.1e}")
    assert moved < 1e-9  # the tightest of their budgets
