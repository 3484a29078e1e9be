"""Sweeps: what they try, what they keep, what they choose. On kernels with made-up speeds."""

from __future__ import annotations

import itertools
import math
import os
import random
import signal
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

import generator.registry.axes as axes_module
from generator.api import Swept
from generator.choice.seeds import steppers_of
from generator.choice.trials import Final, Rejection, Run
from generator.choice.workbench import TimingJob
from generator.cli.interrupts import kept
from generator.cli.watch import say_outcomes
from generator.errors import InputError, KernelCrash
from generator.evidence.records.evidence import NEGLIGIBLE, read_timings
from generator.registry.axes import Axis, Choice, axes_of
from generator.registry.names import name_of
from generator.registry.question import Contest
from generator.registry.rules import broken_rule
from generator.registry.variant import Variant
from generator.sweep.finals import beaten_by
from generator.sweep.ladder import KEPT, RUNGS, Entry, finalists, promoted
from generator.sweep.recheck import verify_choice
from generator.sweep.search import Search
from generator.sweep.space import Space, parse_only
from generator.sweep.store import opened
from generator.sweep.sweep import explorations
from tests.support.kernels import ROOT
from tests.support.sweep_lab import (
    BATCH,
    EXACT,
    EXACT_BATCH,
    FIXED,
    ZEN3,
    FakeLab,
    landscape,
    plan,
    swept,
)
from tests.support.sweep_records import trial as timed_trial

STRICT = {"flags": ("strict",)}
SMALL = {"simd": ("scalar",), "store": ("named",), "fma": ("fma",), "loop": ("onestage",)}
SMALLER = {**STRICT, **SMALL, "branch": ("chosen",), "state": ("reduced",)}
SAMPLED = {**STRICT, "store": ("named",), "fma": ("fma",)}
COLOUR = Axis("colour", "of the ink", (Choice("plain", "none"), Choice("bold", "thick")))


@pytest.fixture
def tmp_path() -> Iterator[Path]:
    """In memory where there is such a place: most of the time would go into flushing to a disk."""
    memory = Path("/dev/shm")
    with TemporaryDirectory(dir=memory if os.access(memory, os.W_OK) else None) as name:
        yield Path(name)


def space(only: dict[str, tuple[str, ...]]) -> Space:
    return Space(FIXED, ZEN3, ("gcc",), (1,), only)


def chosen(final: Final | None) -> Variant:
    assert final is not None
    return final.row(final.chosen).subject.variant()


# ---- what is tried ---------------------------------------------------------------------------


def test_an_exhaustive_sweep_tries_every_legal_variant_once_and_no_other(tmp_path: Path) -> None:
    legal = {name_of(v) for v in space(SMALLER).everything()}
    axes, by_hand = space(SMALLER).axes(1), 0
    for codes in itertools.product(*(codes for _, codes in axes)):
        options = dict(zip((a.key for a, _ in axes), codes, strict=True))
        drawn = next(space(SMALLER).everything()).with_options(**options)
        by_hand += broken_rule(drawn, ZEN3) is None
    with opened(tmp_path / "s.sqlite") as store:
        [outcome], _ = swept(store, FakeLab(), plan(FIXED, only=SMALLER, exhaustive=True))
        trials = [t for t in store.trials() if t.depends is not None]
    names = Counter(t.subject.name for t in trials if t.rung == 0)
    print(f"{len(legal)} legal variants, {sum(names.values())} trials on the lowest rung")
    assert set(names) == legal == set(outcome.exploration.entries)
    assert set(names.values()) == {1} and len(legal) == by_hand > 10
    assert outcome.exploration.complete


def test_a_search_tries_legal_variants_only_each_once_and_every_option(tmp_path: Path) -> None:
    with opened(tmp_path / "s.sqlite") as store:
        swept(store, FakeLab(), plan(FIXED, trials=100))
        trials = [t for t in store.trials() if t.rung == 0 and t.depends is not None]
    variants = [t.subject.variant() for t in trials]
    assert len({name_of(v) for v in variants}) == len(variants) == 100
    assert all(broken_rule(v, ZEN3) is None for v in variants)
    seen = {pair for v in variants for pair in v.options}
    wanted = {(a.key, code) for a, codes in space({}).axes(1) for code in codes}
    print(f"{len(wanted)} options, not tried: {sorted(wanted - seen)}")
    assert wanted == seen


@pytest.mark.parametrize("contest", [BATCH, EXACT_BATCH])
def test_a_sweep_of_batches_begins_with_the_widest_lanes(contest: Contest, tmp_path: Path) -> None:
    """With all steppers, so that one that ends early has tried what is likely to win."""
    with opened(tmp_path / "s.sqlite") as store:
        [outcome], _ = swept(store, FakeLab(), plan(contest, trials=6))
    tried = [e.variant for e in outcome.exploration.entries.values()]
    widths = Counter((v.stepper.name, v.width) for v in tried)
    print(f"{contest}: {dict(widths)}")
    steppers = {stepper.name for stepper in steppers_of(contest)}
    assert {name for name, width in widths if width == 4} == steppers
    assert sum(n for (_, width), n in widths.items() if width == 4) >= len(tried) / 2


def test_part_of_an_exhaustive_sweep_is_a_fair_sample_that_the_seed_tells() -> None:
    def first(seed: int, count: int) -> list[Variant]:
        return Search(space(SAMPLED), (), random.Random(seed), True).next_wave(count, [])

    everything = list(space(SAMPLED).everything())
    sample = first(1, 400)
    assert sample == first(1, 400) != first(2, 400)
    assert {name_of(v) for v in first(1, len(everything))} == {name_of(v) for v in everything}
    for axis, codes in space(SAMPLED).axes(1):
        for code in codes:
            share, wanted = (
                sum(v[axis.key] == code for v in some) / len(some) for some in (sample, everything)
            )
            allowed = 4 * math.sqrt(wanted * (1 - wanted) / len(sample))  # standard deviations
            assert abs(share - wanted) <= allowed, (axis.key, code, share, wanted)


def test_what_has_an_option_that_was_always_rejected_comes_last(tmp_path: Path) -> None:
    """The model of times knows nothing of it: it would promise as much as the mean."""

    def refuse(variant: Variant) -> Rejection | None:
        bad = variant["rsqrt"] in ("est1", "est2")
        return Rejection(reason="wrong result", text="made to") if bad else None

    with opened(tmp_path / "s.sqlite") as store:
        asked = plan(FIXED, only=STRICT, trials=150)
        [outcome], _ = swept(store, FakeLab(refuse=refuse), asked)
    order = [refuse(e.variant) is not None for e in outcome.exploration.entries.values()]
    late = sum(order[-100:])
    print(f"rejected: {sum(order)} of {len(order)}, of the last 100 {late}")
    assert sum(order) > 3  # some were: the options had to be tried
    assert late <= 100 / 6  # those drawn at random


def test_who_may_be_the_fastest_by_its_interval_is_timed_for_longer() -> None:
    """On a busy machine a rung's intervals may span a factor of six."""

    def entry(number: int, ratio: float, low: float) -> Entry:
        made = timed_trial(ratio)
        times = made.times.model_copy(update={"ratio": ratio, "ratio_ci": (low, 9.0)})
        variant = next(space({**SMALLER, "rsqrt": ("inv",)}).everything())
        subject = made.subject.model_copy(update={"name": f"kernel {number}"})
        return Entry(variant, [made.model_copy(update={"times": times, "subject": subject})])

    sure = [entry(n, 0.5 + 0.1 * n, 0.49 + 0.1 * n) for n in range(8)]
    wide = entry(8, 1.4, 0.4)
    assert promoted([*sure, wide], 0) == [*sure[:3], wide]
    assert promoted(sure, 0) == sure[:2]


def test_who_was_timed_beside_other_work_is_timed_once_more() -> None:
    """By its interval none of these may be the fastest, but one had not the core for itself."""

    def entry(name: str, ratio: float, quiet: float | None, rungs: int) -> Entry:
        variant = next(space(SMALLER).everything())
        trials = [timed_trial(ratio, rung, state=name) for rung in range(rungs)]
        for i, made in enumerate(trials):
            assert made.times is not None
            times = made.times.model_copy(update={"quiet": quiet})
            trials[i] = made.model_copy(update={"times": times})
        return Entry(variant, trials)

    best = [entry(f"best{i}", 0.1 + i / 1000, 1.0, 2) for i in range(4)]
    slow = [entry("quiet", 0.14, 1.0, 1), entry("old", 0.14, None, 1)]
    disturbed = entry("disturbed", 0.14, 0.1, 1)
    assert promoted([*best, *slow, disturbed], 0) == [disturbed]
    again = entry("again", 0.14, 0.1, 2)  # the longer timing is believed as it is
    assert again not in promoted([*best, *slow, again], 1)


def test_who_was_disturbed_in_its_longest_timing_alone_is_in_the_final() -> None:
    variant = next(space(SMALLER).everything())
    ratios = {"disturbed": (0.1, 0.1, 0.12), "steady": (0.11, 0.1, 0.1), "slow": (0.13, 0.12, 0.12)}
    entries = {
        name: Entry(variant, [timed_trial(ratio, rung) for rung, ratio in enumerate(seen)])
        for name, seen in ratios.items()
    }
    last = [entries["disturbed"], entries["steady"], entries["slow"]]
    crowd = [Entry(variant, [timed_trial(0.1 + n / 1e4)]) for n in range(8)]
    chosen_ones = finalists([*last, *crowd])
    print(f"{len(chosen_ones)} of {len(last) + len(crowd)} in the final")
    assert entries["disturbed"] in chosen_ones and entries["steady"] in chosen_ones
    assert entries["slow"] not in chosen_ones


def test_a_choice_can_be_timed_against_the_kernels_of_another_store(tmp_path: Path) -> None:
    """As against those of an exhaustive sweep, of which the first one saw a part."""
    slow = plan(FIXED, only={**SMALLER, "rsqrt": ("inv",)}, exhaustive=True)
    lab = FakeLab(speed=lambda v: 0.5 if v["rsqrt"] == "ahead" else 0.6)
    with opened(tmp_path / "all.sqlite") as rivals, opened(tmp_path / "s.sqlite") as store:
        swept(rivals, lab, plan(FIXED, only=SMALLER, exhaustive=True))
        [outcome], ledger = swept(store, lab, slow)
        again = explorations(slow, lab, ledger, lambda progress: None)
        held = verify_choice(again[0], store, 5)
        beaten = verify_choice(again[0], store, 5, rivals)
    assert outcome.final is not None and held.chosen == beaten.chosen == outcome.final.chosen
    assert not any(b.clear for b in beaten_by(held))
    [first, *_] = beaten_by(beaten)
    print(f"beaten by {100 * (first.gain - 1):.1f} %: {first.name}")
    assert first.clear and first.gain == pytest.approx(1.2, abs=0.02)


def test_a_new_axis_is_swept_without_being_told(monkeypatch: pytest.MonkeyPatch) -> None:
    before = list(space(SMALLER).everything())
    monkeypatch.setattr(axes_module, "AXES", (*axes_module.AXES, COLOUR))
    after = list(space(SMALLER).everything())
    assert len(after) == 2 * len(before)
    assert {v["colour"] for v in space(SMALLER).neighbours(after[0])} == {"plain", "bold"}


def test_the_chosen_kernels_illegal_neighbours_are_kept_with_the_rule(tmp_path: Path) -> None:
    for _ in range(2):  # the second time there is nothing to add
        with opened(tmp_path / "s.sqlite") as store:
            [outcome], _ = swept(store, FakeLab(), plan(FIXED, trials=40))
            found = [t for t in store.trials() if t.depends is None]
    best = chosen(outcome.final)
    illegal = [v for v in space({}).steps_from(best) if broken_rule(v, ZEN3) is not None]
    print(f"{len(illegal)} illegal neighbours of {name_of(best)}")
    assert {t.subject.name for t in found} >= {name_of(v) for v in illegal}
    assert len({t.key for t in found}) == len(found) > 0
    for trial in found:
        assert trial.rejection is not None and trial.rejection.reason == "constraint"
        rule = broken_rule(trial.subject.variant(), ZEN3)
        assert rule is not None and trial.rejection.text == f"{rule.name}: {rule.reason}"


def test_only_the_better_quarter_of_a_rung_is_timed_for_longer(tmp_path: Path) -> None:
    with opened(tmp_path / "s.sqlite") as store:
        swept(store, FakeLab(noise=0.002), plan(FIXED, only=SMALLER, exhaustive=True))
        trials = [t for t in store.trials() if t.depends is not None]
    count = Counter(t.rung for t in trials)
    print(f"trials by rung: {dict(count)}")
    assert {t.times.rounds for t in trials if t.times} == set(RUNGS)
    # A wave may promote one that a later wave outdoes: at most a few beyond the quarter.
    assert count[0] / KEPT <= count[1] <= count[0] / KEPT + 8
    assert count[1] / KEPT <= count[2] <= count[1] / KEPT + 8
    at_first = {t.subject.name: t.times.ratio for t in trials if t.rung == 0 and t.times}
    best = sorted(at_first, key=lambda name: at_first[name])[: count[0] // KEPT]
    assert set(best) <= {t.subject.name for t in trials if t.rung == 1}


# ---- what is chosen --------------------------------------------------------------------------


def test_a_contest_of_batches_varies_lanes_and_not_the_loop_of_single_calls(
    tmp_path: Path,
) -> None:
    with opened(tmp_path / "s.sqlite") as store:
        asked = plan(BATCH, exhaustive=True)
        [outcome], _ = swept(store, FakeLab(), asked)
        tried = [t.subject.variant() for t in store.trials() if t.rung == 0 and t.depends]
    axes = axes_of("fixed", 4)
    seen = {axis.key: {v[axis.key] for v in tried} for axis in axes}
    print({key: sorted(codes) for key, codes in seen.items() if len(codes) > 1})
    assert {v.width for v in tried} == {2, 4} and len(tried) == len(set(tried)) > 50
    for axis in axes:
        alone = axis.family == "euler" and not axis.lanes
        assert len(seen[axis.key]) == 1 if alone else True
        of_steps = set(axis.codes()) - {"est0", "s2"}  # those are of exact lanes alone
        assert seen[axis.key] == of_steps or not axis.lanes
    best = min(landscape(v) for v in asked.space(BATCH).everything())
    assert landscape(chosen(outcome.final)) <= 1.03 * best


def test_no_finalist_is_faster_than_the_fastest_in_the_same_rounds(tmp_path: Path) -> None:
    """Also where times are skewed, as those of batches whose windows hold different cases."""

    class Skewed(FakeLab):
        def _series(self, name: str, ratio: float, rounds: int) -> dict[str, Any]:
            series = super()._series(name, ratio, rounds)
            tail = random.Random(name)
            ns = [value * (1 + 0.2 * tail.random() ** 8) for value in series["ns_per_collision"]]
            return {**series, "ns_per_collision": ns}

    with opened(tmp_path / "s.sqlite") as store:
        [outcome], _ = swept(store, Skewed(), plan(FIXED, only=SMALLER, exhaustive=True))
    assert outcome.final is not None
    least = min(row.to_fastest for row in outcome.final.finalists)
    print(f"{len(outcome.final.finalists)} finalists, the least ratio to the fastest is {least}")
    assert least == 1.0 == outcome.final.row(outcome.final.fastest).to_fastest


@pytest.mark.parametrize("seed", [1, 2])
def test_a_search_of_300_trials_finds_what_an_exhaustive_one_would_choose(
    seed: int, tmp_path: Path
) -> None:
    """On times with an effect of each option and of each pair, and 1 % noise."""
    ratios = sorted(landscape(v) for v in space(STRICT).everything())
    with opened(tmp_path / "s.sqlite") as store:
        asked = plan(FIXED, trials=300, seed=seed)
        [outcome], _ = swept(store, FakeLab(seed), asked)
    ratio = landscape(chosen(outcome.final))
    print(
        f"seed {seed}: chosen {ratio:.4f}, the best of {len(ratios)} is {ratios[0]:.4f}: "
        f"beaten by {100 * (ratio / ratios[0] - 1):.2f} % after {outcome.exploration.tried} trials"
    )
    assert ratio <= 1.03 * ratios[0]


def test_two_sweeps_choose_the_same_kernel_or_name_it_as_a_tie(tmp_path: Path) -> None:
    finals = []
    for seed in (1, 2):
        with opened(tmp_path / f"{seed}.sqlite") as store:
            outcomes, _ = swept(store, FakeLab(seed), plan(EXACT, FIXED, trials=240))
            finals.append([o.final for o in outcomes])
    for first, second in zip(*finals, strict=True):
        assert first is not None and second is not None
        print(f"{first.contest}: {first.chosen} and {second.chosen}")
        assert first.chosen == second.chosen or (
            {first.chosen, second.chosen} <= set(first.ties) & set(second.ties)
        )


@pytest.mark.parametrize("least", [0.499, 0.4955])
def test_of_ties_the_fewest_options_from_the_default_are_chosen(
    least: float, tmp_path: Path
) -> None:
    """Also of those that can be told apart, but by less than 1 %."""
    with opened(tmp_path / "s.sqlite") as store:
        lab = FakeLab(noise=0.0, speed=lambda v: 0.5 if v["rsqrt"] != "ahead" else least)
        [outcome], _ = swept(store, lab, plan(FIXED, only=SMALLER, exhaustive=True))
    final = outcome.final
    assert final is not None
    fastest = final.row(final.fastest)
    assert fastest.subject.options["rsqrt"] == "ahead"
    own = final.row(final.chosen)
    assert own.tie and own.to_fastest <= NEGLIGIBLE
    assert own.distance == min(row.distance for row in final.finalists if row.tie)
    assert any(row.subject.options["rsqrt"] != "ahead" for row in final.finalists if row.tie)


def test_what_is_slower_by_little_more_than_1_percent_is_a_tie_and_not_chosen(
    tmp_path: Path,
) -> None:
    """Another sweep may measure less and choose it."""
    with opened(tmp_path / "s.sqlite") as store:
        lab = FakeLab(noise=0.0, speed=lambda v: 0.5 if v["rsqrt"] == "ahead" else 0.5075)
        [outcome], _ = swept(store, lab, plan(FIXED, only=SMALLER, exhaustive=True))
    final = outcome.final
    assert final is not None
    others = [row for row in final.finalists if row.subject.options["rsqrt"] != "ahead"]
    assert others and all(row.tie for row in others)
    assert chosen(final)["rsqrt"] == "ahead"


def test_what_is_slower_by_2_percent_is_never_chosen_for_its_fewer_options(tmp_path: Path) -> None:
    with opened(tmp_path / "s.sqlite") as store:
        lab = FakeLab(noise=0.02, speed=lambda v: 0.5 if v["rsqrt"] == "ahead" else 0.51)
        [outcome], _ = swept(store, lab, plan(FIXED, only=SMALLER, exhaustive=True))
    assert chosen(outcome.final)["rsqrt"] == "ahead"


def test_relaxed_arithmetic_is_timed_and_never_chosen(tmp_path: Path) -> None:
    with opened(tmp_path / "s.sqlite") as store:
        lab = FakeLab(speed=lambda v: 0.5 if v["flags"] == "strict" else 0.1)
        [outcome], _ = swept(store, lab, plan(FIXED, trials=100))
        timed = [t for t in store.trials() if t.subject.options.get("flags") == "report"]
    print(f"{len(timed)} trials with the report's flags")
    assert timed and chosen(outcome.final)["flags"] == "strict"


# ---- what is kept ----------------------------------------------------------------------------


def test_a_second_sweep_times_nothing_again(tmp_path: Path) -> None:
    path, asked = tmp_path / "s.sqlite", plan(FIXED, only=SMALLER, exhaustive=True)
    with opened(path) as store:
        _, first = swept(store, FakeLab(1), asked)
    with opened(path) as store:
        before = list(store.records())
        lab = FakeLab(2)
        [outcome], second = swept(store, lab, asked)
        added = [r for r in store.records() if r not in before]
    print(f"made {first.made}, then {second.made}; reused {second.reused}")
    assert (second.made, lab.timed) == (0, []) and second.reused == first.made
    assert [type(r) for r in added] == [Run]
    assert outcome.final in before and not second.unused


def test_adding_an_option_times_nothing_else_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A new axis changes the names of all kernels, and yet no figure of an old one is lost."""
    path = tmp_path / "s.sqlite"
    asked = plan(FIXED, only={**SMALLER, "rsqrt": ("inv", "est1")}, exhaustive=True)
    with opened(path) as store:
        _, first = swept(store, FakeLab(), asked)
        known = {t.key for t in store.trials()}
    monkeypatch.setattr(axes_module, "AXES", (*axes_module.AXES, COLOUR))
    more = plan(FIXED, only={**asked.only, "rsqrt": ("inv", "est1", "est2")}, exhaustive=True)
    with opened(path) as store:
        lab = FakeLab()
        [outcome], second = swept(store, lab, more)
        new = [t for t in store.trials() if t.key not in known and t.depends is not None]
    alone = {names[-1] for names in lab.timed if len(names) == 2}
    print(f"{first.made} trials before, {second.made} made after, {second.reused} reused")
    assert {t.subject.name for t in new} == alone
    options = [t.subject.options for t in new if t.rung == 0]
    assert options and all(o["colour"] == "bold" or o["rsqrt"] == "est2" for o in options)
    assert not second.unused and outcome.final is not None


def test_a_stored_result_that_is_not_used_says_why(tmp_path: Path) -> None:
    path, asked = tmp_path / "s.sqlite", plan(FIXED, only=SMALLER, exhaustive=True)
    legal = len(list(space(SMALLER).everything()))
    with opened(path) as store:
        swept(store, FakeLab(), asked)
    newer = FakeLab()
    newer.compilers["gcc"] = "g++ (made up) 13.1.0"
    with opened(path) as store:
        _, second = swept(store, newer, asked)
    with opened(path) as store:
        _, third = swept(store, newer, asked, fresh=True)
    print(f"{second.unused}\n{third.unused}")
    [(why, count)] = second.unused.items()
    assert "compiler: g++ (made up) 12.2.0, now g++ (made up) 13.1.0" in why
    assert "another baseline" in why and count == legal
    assert third.unused == {"--fresh was given": legal} and third.reused == 0


REASONS = ("compile", "timeout", "crash", "wrong result")


def test_every_rejection_is_a_record_with_its_reason_and_is_not_tried_again(
    tmp_path: Path,
) -> None:
    reasons = dict(zip(("div", "inv", "est1", "est2"), REASONS, strict=True))

    def refuse(variant: Variant) -> Rejection | None:
        reason = reasons.get(variant["rsqrt"]) if variant["flags"] == "strict" else None
        return Rejection(reason=reason, text=f"made to: {reason}") if reason else None

    path = tmp_path / "s.sqlite"
    asked = plan(FIXED, only={**STRICT, **SMALL, "reuse": ("precompute",)}, exhaustive=True)
    with opened(path) as store:
        [outcome], _ = swept(store, FakeLab(refuse=refuse), asked)
        trials = [t for t in store.trials() if t.depends is not None]
    assert outcome.final is not None
    print(dict(outcome.exploration.rejected))
    for trial in trials:
        want = reasons.get(trial.subject.options["rsqrt"])
        assert (trial.rejection.reason if trial.rejection else None) == want
        assert (trial.times is None) == (want is not None)
    assert {f.subject.options["rsqrt"] for f in outcome.final.finalists} <= {"prev", "ahead"}
    with opened(path) as store:
        lab = FakeLab()
        _, again = swept(store, lab, asked)
    assert (again.made, lab.timed) == (0, [])


def test_a_finalist_that_ends_the_final_is_left_out_of_it(tmp_path: Path) -> None:
    class Fragile(FakeLab):
        """The fastest kernel crashes when it has been timed often."""

        def time(self, job: TimingJob) -> dict[str, Any]:
            bad = [c for c in job.kernels if c.variant["rsqrt"] == "ahead"]
            if bad and (len(job.kernels) > 2 or self.crashed):
                self.crashed = True
                raise KernelCrash("crashed with SIGSEGV")
            return super().time(job)

        crashed = False

    with opened(tmp_path / "s.sqlite") as store:
        lab = Fragile(speed=lambda v: 0.5 if v["rsqrt"] == "ahead" else 0.51)
        [outcome], _ = swept(store, lab, plan(FIXED, only=SMALLER, exhaustive=True))
        out = [t for t in store.trials() if t.rejection and t.rejection.reason == "crash"]
    assert outcome.final is not None and lab.crashed
    assert {f.subject.options["rsqrt"] for f in outcome.final.finalists}.isdisjoint({"ahead"})
    assert {t.subject.options["rsqrt"] for t in out} == {"ahead"}


# ---- budgets ---------------------------------------------------------------------------------


def test_a_budget_of_trials_is_kept_to_the_trial_and_shared_by_the_contests(
    tmp_path: Path,
) -> None:
    with opened(tmp_path / "s.sqlite") as store:
        outcomes, _ = swept(store, FakeLab(), plan(EXACT, FIXED, trials=41))
    tried = [o.exploration.tried for o in outcomes]
    print(f"tried {tried}")
    assert tried[0] + tried[1] == 41 and abs(tried[0] - tried[1]) <= 1


def test_a_budget_of_minutes_ends_a_sweep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock that only timings move: what else the machine does takes no time."""
    monkeypatch.setattr("generator.sweep.sweep.FINAL_RESERVE", 0.2)
    now = [1000.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    monkeypatch.setattr(time, "sleep", lambda seconds: now.append(now.pop() + seconds))
    with opened(tmp_path / "s.sqlite") as store:
        asked = plan(EXACT, FIXED, minutes=0.05)
        outcomes, _ = swept(store, FakeLab(seconds=0.02), asked)
    spent = now[0] - 1000.0
    print(f"{spent:.2f} s of {60 * 0.05:g} s; tried {[o.exploration.tried for o in outcomes]}")
    assert 2.0 < spent < 3.6
    assert all(o.final is not None and o.exploration.tried > 0 for o in outcomes)


def test_only_names_what_does_not_exist() -> None:
    assert parse_only(("rsqrt=inv,ahead",)) == {"rsqrt": ("inv", "ahead")}
    with pytest.raises(InputError, match="no axis 'colour'; there are state"):
        parse_only(("colour=red",))
    with pytest.raises(InputError, match="rsqrt has no 'fast'; it has div, inv"):
        parse_only(("rsqrt=inv,fast",))


def test_a_space_without_a_legal_variant_is_refused(tmp_path: Path) -> None:
    with opened(tmp_path / "s.sqlite") as store, pytest.raises(InputError, match="no legal"):
        swept(store, FakeLab(), plan(FIXED, only={"branch": ("chosen",), "rsqrt": ("div",)}))


# ---- the schema is what the page says --------------------------------------------------------


def test_the_page_names_every_field_of_the_records() -> None:
    from generator.choice import trials

    page = (Path(__file__).parents[2] / "docs" / "sweep.md").read_text("utf-8")
    names = ("Run", "Trial", "Final", "Depends", "Subject", "Errors", "Times", "Rejection")
    models = [getattr(trials, name) for name in (*names, "Finalist")]
    fields = {field for model in models for field in model.model_fields} - {"kind"}
    missing = {field for field in fields if f"`{field}`" not in page}
    print(f"{len(fields)} fields, not on the page: {sorted(missing)}")
    assert not missing


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_an_interrupt_that_a_finaliser_lost_stops_the_sweep_at_its_next_step() -> None:
    """SIGINT while `__del__` runs: Python drops its exception."""

    class Last:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGINT)

    told: list[str] = []
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background
    try:
        with kept(told.append) as observe:
            observe("before")
            Last()
            with pytest.raises(KeyboardInterrupt):
                observe("after")
        assert told == ["before"]
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        with kept(told.append) as observe:
            assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


def test_however_few_the_minutes_each_contest_gets_its_first_candidates(tmp_path: Path) -> None:
    """As `gen sweep --minutes 2`, which once spent all on the first of four."""
    with opened(tmp_path / "s.sqlite") as store:
        asked = plan(EXACT, FIXED, EXACT_BATCH, BATCH, minutes=0.001)
        outcomes, _ = swept(store, FakeLab(), asked)
    tried = [outcome.exploration.tried for outcome in outcomes]
    print(tried)
    assert all(0 < count <= 8 for count in tried)
    assert all(outcome.final is not None and not outcome.failed for outcome in outcomes)


def test_a_contest_that_was_not_tried_has_not_failed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with opened(tmp_path / "s.sqlite") as store:
        outcomes, ledger = swept(store, FakeLab(), plan(EXACT, FIXED, trials=1))
    assert [outcome.failed for outcome in outcomes] == [False, False]
    place, unused = tmp_path / "s.sqlite", dict(ledger.unused)
    say_outcomes(Swept(tuple(outcomes), place, None, ledger.made, ledger.reused, unused))
    assert "nothing was tried" in capsys.readouterr().out


def test_what_was_fastest_on_the_cpu_before_is_tried_first(tmp_path: Path) -> None:
    timings = read_timings([ROOT])
    with opened(tmp_path / "s.sqlite") as store:
        lab = FakeLab()
        asked = plan(FIXED, trials=8, only={"compiler": ("gcc",)}, timings=timings)
        swept(store, lab, asked)
    first = timings.fastest(FIXED, 6)
    gcc = [name_of(v) for v in first if v["compiler"] == "gcc"]
    print(gcc)
    assert gcc and [kernels[1] for kernels in lab.timed[: len(gcc)]] == gcc
