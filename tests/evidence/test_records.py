"""Records of timings: text that is reviewed and merged, and what it says of a CPU."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from click.testing import CliRunner

from generator.api import Session
from generator.choice.candidates import batch_candidates
from generator.choice.choose import choose_by_model, choose_by_records
from generator.choice.entries import selected
from generator.choice.folder import write_folder
from generator.choice.kernel import Estimated, Rejected
from generator.choice.model_error import MODEL_ERROR
from generator.choice.recorded import choose_elsewhere
from generator.choice.selection import Selection
from generator.cli.main import gen
from generator.errors import KernelError
from generator.evidence.records.evidence import Found, key_of_kernel, read_timings, timings_of, told
from generator.evidence.records.files import read_records, timings_path, union, write_records
from generator.evidence.records.record import TimingRecord
from generator.evidence.verification.verdict import Verdict
from generator.registry.names import name_of, variant_from, variant_of
from generator.registry.question import Contest, Goal
from generator.registry.variant import Stepper, Variant, fixed_steps, make_variant
from generator.report.sections.cpus import cpu_costs
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.replay import Modelled
from tests.support.contests import exact_candidates, fixed_step_candidates

ROOT = Path(__file__).parents[2]
CODES = ("gcc", "clang", "clangold")
POOLTOOL = Contest("ball-ball", "", "any", "pooltool", Goal(steps=1000), "scalar")


def candidates(target: str, model: str = "pooltool") -> list[Variant]:
    row = find_target(target)
    fixed = fixed_step_candidates(row, "any", model, 1000, CODES)
    exact = exact_candidates(row, "any", model, 1e-6, CODES)
    wide = [v for one in (fixed[-1], exact[0]) for v in batch_candidates(one, row, CODES)]
    return [*fixed, *exact, *wide]


@pytest.mark.parametrize("target", ["x86-64-v2", "zen3", "zen4"])
def test_a_recipe_is_read_back_as_the_variant_it_was_written_of(target: str) -> None:
    for variant in candidates(target):
        assert variant_from(variant.question, str(variant.recipe)) == variant


def test_what_only_single_calls_see_tells_nothing_of_a_batch() -> None:
    [wide, *_] = [v for v in candidates("zen3") if v.width > 1 and v.stepper.name == "dp54"]
    other = wide.with_options(root="est2")
    assert wide.recipe != other.recipe
    assert key_of_kernel(wide) == key_of_kernel(other)
    assert key_of_kernel(wide.in_lanes(1)) != key_of_kernel(other.in_lanes(1))
    lanes = wide.with_options(interleave="i2" if wide["interleave"] != "i2" else "i1")
    assert key_of_kernel(wide) != key_of_kernel(lanes)


def test_the_committed_records_read_and_stand_in_the_order_they_are_written_in(
    tmp_path: Path,
) -> None:
    for path in sorted((ROOT / "timings").glob("*.jsonl")):
        file = read_records(path)
        assert file.damaged == ()
        assert all(name_of(variant_of(r.kernel)) == r.kernel for r in file.records)
        print(f"{path.name}: {len(file.records)} records")
        copy = timings_path(tmp_path, path.stem)
        write_records(copy, reversed(file.records))
        assert copy.read_bytes() == path.read_bytes()


def test_on_a_zen_3_the_recorded_winner_of_pooltool_takes_at_most_037_of_paper_initial() -> None:
    timings = read_timings([ROOT])
    assert timings.damaged == ()
    least = timings.contest("zen3", POOLTOOL)
    winners = timings.winners("zen3", POOLTOOL)
    print(winners[0], least[winners[0]].ratio)
    assert least[winners[0]].ratio <= 0.37
    assert all(winner["rsqrt"] == "ahead" for winner in winners)
    won = winners[0].moved(target="zen3")
    assert timings.wins(won) == 1
    assert timings.wins(won.with_options(rsqrt="prev")) == 0


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


ZEN3 = find_target("zen3")
PASSED = Verdict(True, "", 1e-9, 1e-9, 10)


def candidate(
    rsqrt: str, ratio: float | None = None, cycles: float | None = None, changed: str = ""
) -> Estimated:
    stepper = fixed_steps(1000)
    variant = make_variant("zen3", "any", "pooltool", stepper, fma="fma", rsqrt=rsqrt)
    record = model = None
    if ratio is not None:
        kept = BASE.model_copy(update={"ratio": ratio})
        record = Found(kept, (changed,) if changed else ())
    if cycles is not None:
        model = Modelled("znver3", cycles, 1.0, 32, "19")
    return estimated(variant, record, model)


def estimated(variant: Variant, record: Found | None, model: Modelled | None) -> Estimated:
    nothing: Any = None
    return Estimated(
        variant=variant,
        source=nothing,
        compiler=nothing,
        flags=(),
        library=nothing,
        verdict=PASSED,
        pooltool=None,
        record=record,
        model=model,
    )


BASE = read_records(timings_path(ROOT, "zen3")).records[0]


def test_records_compete_among_themselves_and_the_model_cannot_displace_their_winner() -> None:
    timed = [candidate("inv", 0.6, 900.0), candidate("prev", 0.34, 1000.0)]
    near = candidate("est1", cycles=1000.0 / MODEL_ERROR * 1.01)
    choice = choose_by_records([*timed, near], ZEN3)
    assert (choice.chosen, choice.by) == (timed[1], "records")
    assert choice.evidence.endswith("; 1 more modelled by llvm-mca")
    print(choice.evidence)


def test_what_nobody_timed_is_chosen_where_the_model_puts_it_beyond_its_error() -> None:
    timed = candidate("prev", 0.34, 1000.0)
    far = candidate("est1", cycles=1000.0 / MODEL_ERROR * 0.99)
    choice = choose_by_records([timed, far], ZEN3)
    assert (choice.chosen, choice.by, choice.measured_on) == (far, "llvm-mca", "znver3")


def test_what_other_cpus_say_is_faster_is_chosen_where_the_model_says_so_too() -> None:
    timed = candidate("prev", 0.34, 1000.0)
    near, slower = candidate("est1", cycles=950.0), candidate("inv", cycles=1010.0)

    def lead(one: Variant, other: Variant) -> int:
        assert other == timed.variant
        return 1 if one["rsqrt"] in ("est1", "inv") else 0

    choice = choose_by_records([timed, slower, near], ZEN3, lead)
    print(choice.evidence)
    assert (choice.chosen, choice.by) == (near, "llvm-mca")
    assert choose_by_records([timed, slower], ZEN3, lead).chosen is timed
    assert choose_by_records([timed, near], ZEN3).chosen is timed


def test_a_recipe_leads_where_both_were_timed_and_differ_by_more_than_2_percent() -> None:
    first, second = (candidate(rsqrt).variant for rsqrt in ("inv", "prev"))

    def timed(variant: Variant, ratio: float) -> TimingRecord:
        made = {"question": str(variant.question), "recipe": str(variant.recipe), "ratio": ratio}
        return BASE.model_copy(update=made)

    for ratio, lead in ((0.52, 1), (0.509, 0), (0.30, -1)):
        timings = timings_of([timed(first, 0.50), timed(second, ratio)])
        assert timings.lead(first, second) == lead, ratio
        assert timings.lead(second, first) == -lead, ratio
    assert timings_of([timed(first, 0.5)]).lead(first, second) == 0, "one of them is not timed"


def test_records_of_earlier_code_are_used_and_counted_with_what_changed() -> None:
    some = [candidate("inv", 0.6, changed="kernel text"), candidate("prev", 0.34)]
    choice = choose_by_records(some, ZEN3)
    print(choice.evidence)
    assert choice.evidence == (
        f"timed on AMD EPYC 7003 (zen3), {BASE.day}, 2 records, "
        "1 of them of earlier code (kernel text)"
    )
    entry = selected(choice)
    assert (entry.chosen_by, entry.evidence) == ("records", choice.evidence)
    assert entry.ratio_to_baseline == 0.34


def test_a_record_of_the_code_as_it_is_goes_before_one_of_earlier_code() -> None:
    variant = variant_of(BASE.kernel)
    narrow = BASE.model_copy(update={"ratio_ci": (BASE.ratio, BASE.ratio)})
    now = BASE.basis.model_copy(update={"source": "0" * 16, "compiler": "another"})
    own = BASE.model_copy(update={"basis": now})
    earlier = timings_of([narrow]).find("zen3", variant, now)
    assert earlier is not None and earlier.changed == ("kernel text", "compiler")
    current = timings_of([narrow, own]).find("zen3", variant, now)
    assert current is not None and (current.record, current.changed) == (own, ())
    assert timings_of([narrow]).find("zen4", variant, now) is None


def test_where_a_contact_model_was_not_timed_the_same_recipes_of_another_tell_more() -> None:
    timings = read_timings([ROOT])
    pooltool = timings.fastest(replace(POOLTOOL, target="zen3"), 1)[0]
    other = pooltool.moved(model="bottom_slip")
    found = timings.find("zen3", other, BASE.basis)
    if found is not None and found.contest:  # until a Zen 3 has timed it
        assert told([found]).endswith(f"1 records of {found.contest}, as none of these kernels")
    assert timings.nearest("zen3", replace(POOLTOOL, goal=Goal(steps=999))) is None
    closed = Contest("ball-ball", "", "stun", "pooltool", Goal(budget=1e-6), "scalar")
    assert timings.nearest("zen3", closed) is None, "a closed form is another"


def test_of_what_the_model_cannot_tell_apart_the_recipe_that_won_on_more_cpus_is_chosen() -> None:
    some = [candidate("inv", cycles=1000.0), candidate("prev", cycles=1000.5)]
    assert choose_by_model(some, "znver3").chosen is some[0]
    wins = {"inv": 0, "prev": 2}
    assert choose_by_model(some, "znver3", lambda v: wins[v["rsqrt"]]).chosen is some[1]


def cpuinfo(family: int, model: int, *flags: str) -> str:
    named = "avx avx2 fma f16c bmi1 bmi2 abm movbe sse2 pni ssse3 sse4_1 sse4_2 popcnt"
    return (
        f"vendor_id\t: AuthenticAMD\ncpu family\t: {family}\nmodel\t\t: {model}\n"
        f"model name\t: AMD EPYC\nflags\t\t: {' '.join((named, *flags))}\n"
    )


AVX512 = ("avx512f", "avx512vl", "avx512dq", "avx512bw", "avx512cd")


@pytest.mark.skipif(platform.machine() != "x86_64", reason="/proc/cpuinfo of x86")
@pytest.mark.parametrize(
    ("text", "target", "exact"),
    [
        (cpuinfo(25, 1), "zen3", True),
        (cpuinfo(25, 17, *AVX512), "zen4", True),
        (cpuinfo(25, 17), "x86-64-v3", False),  # a Zen 4 whose AVX-512 a hypervisor hides
        (cpuinfo(23, 1), "x86-64-v3", False),  # a Zen 1
        (cpuinfo(23, 49), "zen2", True),
    ],
)
def test_a_host_is_a_named_cpu_only_where_cpuid_says_so(
    text: str, target: str, exact: bool
) -> None:
    host = read_host(text)
    assert (host.target.name, host.exact) == (target, exact)
    assert host.is_a(find_target(target)) == exact
    assert (host.vendor, host.family) == ("AuthenticAMD", int(text.split("family\t: ")[1][:2]))


def test_a_batch_kernel_of_another_width_takes_the_place_of_the_one_before() -> None:
    stepper = Stepper("dp54", budget=1e-6)
    x8, x4 = (make_variant("zen3", "any", "mathavan2014", stepper, w) for w in (8, 4))
    entries = []
    for variant in (x8, x4):
        made = replace(candidate("inv", 0.1), variant=variant)
        entries.append(selected(choose_by_records([made], ZEN3)))
    empty = Selection(impact="ball-ball", target="zen3", resolved="zen3", scene="any", kernels=[])
    both = empty.with_entries(entries[:1]).with_entries(entries[1:])
    assert [entry.width for entry in both.kernels] == [4]


def test_the_banner_says_what_a_choice_rests_on_and_emit_gives_the_same_bytes(
    tmp_path: Path,
) -> None:
    made = candidate("inv", 0.34, changed="kernel text")
    entry = selected(choose_by_records([made], ZEN3))
    folder = tmp_path / "generated" / "ball-ball" / "zen3" / "any"
    write_folder(
        folder,
        Selection(impact="ball-ball", target="zen3", resolved="zen3", scene="any", kernels=[entry]),
    )
    text = (folder / entry.file).read_text("utf-8")
    print(next(line for line in text.splitlines() if "chosen:" in line))
    assert f"// chosen:   {entry.evidence}\n" in text
    here = Session(root=tmp_path)
    asked = ["emit", str(folder / entry.file)]
    assert CliRunner().invoke(gen, asked, obj=here).stdout == text


def test_a_page_says_what_the_kernel_chosen_for_one_cpu_costs_on_another() -> None:
    rows = [("zen3", "dp54", 0.02), ("zen3", "dp54 root=est1", 0.03)]
    rows += [("zen4", "dp54", 0.05), ("zen4", "dp54 root=est1", 0.04)]
    rows += [("zen4", "dp54 root=cubic compiler=clang", 0.0399)]
    records = [
        BASE.model_copy(
            update={
                "question": f"ball-ball/{cpu}/any/pooltool-e1m06-x1",
                "recipe": recipe,
                "ratio": ratio,
                "cpu": BASE.cpu.model_copy(update={"target": cpu}),
            }
        )
        for cpu, recipe, ratio in rows
    ]
    costs = cpu_costs(timings_of(records), "any", "pooltool")
    found = {(c["made_for"], c["timed_on"]): (c["recipe"], c["cost"], c["records"]) for c in costs}
    print(found)
    assert found["zen3", "zen3"] == ("x1 dp54", 1.0, 2)
    assert found["zen3", "zen4"] == ("x1 dp54", 0.05 / 0.0399, 3)
    assert found["zen4", "zen3"] == ("x1 dp54 root=est1", 0.03 / 0.02, 2)
    assert cpu_costs(timings_of(records), "any", "mathavan2014") == []


def test_a_timed_kernel_that_the_model_cannot_take_is_chosen_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    timed, other = candidate("inv", 0.3), candidate("est1")

    def model(_bench: object, _contest: object, some: Sequence[Estimated]) -> dict[str, Any]:
        return {each.name: KernelError("not to be replayed") for each in some}

    monkeypatch.setattr("generator.choice.recorded.noted", lambda *known: [timed, other])
    monkeypatch.setattr("generator.choice.recorded.model_all", model)
    bench = SimpleNamespace(timings=timings_of([]))
    [kept, out], choice = choose_elsewhere(
        bench, replace(POOLTOOL, target="zen3"), [timed, other], 0
    )  # type: ignore[arg-type]
    assert (choice.chosen, choice.by, kept) == (timed, "records", timed)
    assert isinstance(out, Rejected) and out.text == "llvm-mca: not to be replayed"
