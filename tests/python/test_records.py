"""Records of timings: text that is reviewed and merged, and what it says of a CPU."""

from __future__ import annotations

from pathlib import Path

import pytest

from generator.choice.candidates import batch_candidates, exact_candidates, fixed_step_candidates
from generator.records.evidence import key_of_kernel, read_timings
from generator.records.files import read_records, timings_path, union, write_records
from generator.records.recipe import contest_of, recipe_of, variant_of_recipe
from generator.targets.target import find_target
from generator.variants.variant import Variant

ROOT = Path(__file__).parents[2]
CODES = ("gcc", "clang", "clangold")


def candidates(target: str, model: str = "pooltool") -> list[Variant]:
    row = find_target(target)
    fixed = fixed_step_candidates(row, "any", model, 1000, CODES)
    exact = exact_candidates(row, "any", model, 1e-6, CODES)
    wide = [v for one in (fixed[-1], exact[0]) for v in batch_candidates(one, row, CODES)]
    return [*fixed, *exact, *wide]


@pytest.mark.parametrize("target", ["x86-64-v2", "zen3", "zen4"])
def test_a_recipe_is_read_back_as_the_variant_it_was_written_of(target: str) -> None:
    for variant in candidates(target):
        contest = contest_of(variant, variant.width > 1)
        assert variant_of_recipe(contest, recipe_of(variant)) == variant


def test_what_only_single_calls_see_tells_nothing_of_a_batch() -> None:
    [wide, *_] = [v for v in candidates("zen3") if v.width > 1 and v.stepper.name == "dp54"]
    other = wide.with_options(root="est2")
    assert recipe_of(wide) != recipe_of(other)
    assert key_of_kernel(wide, True) == key_of_kernel(other, True)
    assert key_of_kernel(wide, False) != key_of_kernel(other, False)
    lanes = wide.with_options(interleave="i2" if wide["interleave"] != "i2" else "i1")
    assert key_of_kernel(wide, True) != key_of_kernel(lanes, True)


def test_the_committed_records_read_and_stand_in_the_order_they_are_written_in(
    tmp_path: Path,
) -> None:
    for path in sorted((ROOT / "timings").glob("*.jsonl")):
        file = read_records(path)
        assert file.damaged == ()
        print(f"{path.name}: {len(file.records)} records")
        copy = timings_path(tmp_path, path.stem)
        write_records(copy, reversed(file.records))
        assert copy.read_bytes() == path.read_bytes()


def test_on_a_zen_3_the_recorded_winner_of_pooltool_takes_at_most_037_of_paper_initial() -> None:
    timings = read_timings(ROOT)
    assert timings.damaged == ()
    least = timings.contest("zen3", "any/pooltool/n1000/scalar")
    winners = timings.winners("zen3", "any/pooltool/n1000/scalar")
    print(winners[0], least[winners[0]].ratio)
    assert least[winners[0]].ratio <= 0.37
    assert all("rsqrt=ahead" in winner for winner in winners)
    won = variant_of_recipe("zen3/any/pooltool/n1000/scalar", winners[0])
    assert timings.wins(won, False) == 1
    assert timings.wins(won.with_options(rsqrt="prev"), False) == 0


def test_a_union_is_the_same_in_either_order_and_done_twice_the_same() -> None:
    records = read_records(timings_path(ROOT, "zen3")).records
    a, b = records[:300], records[200:]
    assert union(a, b) == union(b, a) == union(union(a, b), a) == union(records)


def test_a_damaged_line_is_named_with_what_is_wrong_and_the_rest_is_used(tmp_path: Path) -> None:
    lines = timings_path(ROOT, "zen3").read_text("utf-8").splitlines()[:5]
    lines[1] = lines[1][:200]
    lines[3] = lines[3].replace('"ratio":', '"ratio":-')
    path = tmp_path / "zen3.jsonl"
    path.write_text("\n".join(lines) + "\n", "utf-8")
    file = read_records(path)
    assert len(file.records) == 3
    short, negative = file.damaged
    assert short.startswith(f"{path}:2: ") and "JSON" in short
    assert negative.startswith(f"{path}:4: ratio: ") and "greater than 0" in negative
