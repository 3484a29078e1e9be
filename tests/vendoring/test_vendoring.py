"""gen vendor: what it refuses, what it writes, and how it tells a folder's state."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import generator.vendoring.folder as folder_room
import generator.vendoring.package as package
from generator.choice.selection import FILE as SELECTION
from generator.choice.selection import Selection
from generator.choice.workbench import Workbench
from generator.cli.main import gen
from generator.errors import InputError
from generator.files import write_file
from generator.impacts.ball_ball.evidence.measure import errors_of
from generator.impacts.ball_ball.scene import find_scene
from generator.lowering.isa import compiled_features
from generator.registry.question import DEFAULT_IMPACT, Goal
from generator.targets.host import KNOWN_CPUS, read_host
from generator.targets.target import targets
from generator.toolchain.compilers import find_compilers
from generator.vendoring.dispatch import CPUID_BITS, dispatch_context, preferred_order
from generator.vendoring.folder import require_replaceable, staged, write_files
from generator.vendoring.golden import golden_rows
from generator.vendoring.job import compare
from generator.vendoring.kernels import Places, TargetKernels, kernels_for, stored_kernels
from generator.vendoring.manifest import FILE, read_manifest
from tests.support.kernels import CACHE, ROOT, bench_tool
from tests.support.reference import load_reference
from tests.support.vendored import EXACT, files_for, record_for, request_for, vendored

STEPS = Goal(steps=1000)
TARGETS = "zen3,x86-64-v2"


def call(*arguments: object) -> Result:
    return CliRunner().invoke(gen, ["vendor", *map(str, arguments)])


def nowhere(folder: Path) -> Places:
    """No selection is stored anywhere."""
    return Places(folder / "generated", folder / "selections")


# ---- what is refused ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("--target", "zen9"), ("--target zen9", "zen3")),
        (("--target", "zen3,zen3"), ("zen3 twice",)),
        (("--target", "zen3,"), ("--target",)),
        (("--scene", "moon"), ("--scene moon", "pool")),
        (("--model", "moon"), ("--model moon", "pooltool")),
        (("--prefix", "../evil"), ("--prefix '../evil'", "lower-case")),
        (("--prefix", "a b"), ("--prefix 'a b'",)),
        (("--prefix", "_a"), ("--prefix '_a'",)),
        (("--prefix", "a__b"), ("--prefix 'a__b'",)),
        (("--prefix", "Carom"), ("--prefix 'Carom'",)),
        (("--prefix", "template"), ("taken by C or C++",)),
        (("--prefix", "x" * 41), ("at most 40",)),
        (("--max-error", "1e-20"), ("--max-error 1e-20", "1e-12")),
        (("--max-error", "nan"), ("--max-error nan",)),
        (("--steps", "10", "--max-error", "1e-3"), ("exclude each other",)),
        (("--steps", "0"), ("--steps",)),
        (("--steps", "10", "--scene", "arcade"), ("--steps: scene arcade", "--max-error")),
    ],
)
def test_bad_requests_are_refused_in_one_line(arguments, parts, tmp_path) -> None:
    given = {"--target": "x86-64-v2", "--out": tmp_path / "out"}
    given |= dict(zip(arguments[::2], arguments[1::2], strict=True))
    result = call(*(word for pair in given.items() for word in pair))
    print(result.stderr)
    assert result.exit_code == 2 and result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    for part in parts:
        assert part in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_places_that_would_lose_something_are_refused(tmp_path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("x")
    (tmp_path / "file").write_text("x")
    made = vendored(tmp_path / "made", request_for(TARGETS, STEPS))
    (made / "carom.h").write_text("mine now\n")
    for place, forced, reason in (
        (tmp_path / "mine", True, "holds other files"),
        (tmp_path / "file", True, "is no folder"),
        (made, False, "carom.h was edited by hand"),
    ):
        with pytest.raises(InputError, match=reason) as caught:
            require_replaceable(place, edited_too=forced)
        print(caught.value)
        result = call("--target", TARGETS, "--steps", 1000, "--out", place)
        assert result.exit_code == 2 and reason in result.stderr
    require_replaceable(made, edited_too=True)
    assert (tmp_path / "mine" / "thesis.tex").read_text() == "x"


# ---- what is written ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("scene", "goal"), [("any", ("--steps", 1000)), ("any", ("--max-error", 1e-6))]
)
def test_the_command_writes_from_stored_choices_the_same_bytes_each_time(
    scene, goal, tmp_path
) -> None:
    """generated/ holds choices of fixed steps, and of 1e-6: nothing is timed."""
    texts = []
    for name in ("one", "two", "two"):  # the last replaces a folder that is as it was
        out = tmp_path / name
        result = call("--target", TARGETS, "--scene", scene, *goal, "--out", out)
        assert result.exit_code == 0, result.stderr
        assert "timing" not in result.stderr and "verifying" not in result.stderr
        texts.append({p.name: p.read_bytes() for p in out.iterdir()})
    assert texts[0] == texts[1] == texts[2]
    assert {"carom_zen3_batch.cpp", "carom_x86_64_v2_batch.cpp"} <= set(texts[0])
    assert sorted(p.name for p in tmp_path.iterdir()) == ["one", "two"]
    chosen = json.loads(
        (ROOT / "generated" / "ball-ball" / "zen3" / scene / SELECTION).read_text()
    )["kernels"]
    first = read_manifest(tmp_path / "one").kernels[0]
    assert first.batch is not None
    assert all(made.model_dump(mode="json") in chosen for made in (first.record, first.batch))
    assert call("--verify", tmp_path / "one").exit_code == 0


def test_every_file_states_its_licence_and_nothing_of_this_machine() -> None:
    for request in (request_for(TARGETS), request_for(TARGETS, single_header=True)):
        for name, text in files_for(request).items():
            assert "MIT-0" in text, name
            assert str(ROOT) not in text and os.uname().nodename not in text, name
            assert text.isascii() and text.endswith("\n"), name


def test_one_kernel_alone_needs_no_dispatcher() -> None:
    files = files_for(request_for("x86-64-v2", STEPS))
    assert [name for name in files if name.endswith(".cpp")] == ["carom_x86_64_v2.cpp"]
    assert "use_target" not in files["carom.h"] and "use_target" not in files["carom.hpp"]


def test_manifest_holds_what_users_must_know() -> None:
    files = files_for(request_for(TARGETS))
    document = json.loads(files[FILE])
    assert document["options"]["targets"] == ["zen3", "x86-64-v2"]
    assert document["error"]["bound"] == 1e-6 and "5000 random" in document["error"]["found"]
    assert set(document["files"]) == set(files) - {FILE}
    assert {k["record"]["chosen_by"] for k in document["kernels"]} == {"default"}


@pytest.mark.parametrize("model", ["mathavan2014", "pooltool"])
def test_golden_vectors_agree_with_the_reference(model) -> None:
    """The oracle's answers to cases of the reference, against the reference's own (decimals)."""
    rows = golden_rows(bench_tool(), find_scene("any"), model, EXACT)
    reference = load_reference()
    worst = 0.0
    for row in rows:
        balls = [float.fromhex(x) for x in row.bodies]
        (index,) = np.flatnonzero((reference.cases[:, 6:] == balls).all(axis=1))
        assert row.kind == reference.kinds[index]
        want = [float.fromhex(x) for x in row.want]
        scale = np.tile([1.0, 1.0, 1.0, *[float.fromhex(row.radius)] * 3], 2)
        difference = np.abs(want - reference.exact[model][index, :12]) * scale
        worst = max(worst, difference.max() / float.fromhex(row.speed))
    print(f"{len(rows)} rows, largest difference {worst:.2g} of the relative speed")
    assert len(rows) > 30 and worst < 2e-11


def test_golden_vectors_of_fixed_steps_stay_when_inputs_are_rounded_otherwise() -> None:
    """A loop that ends on a comparison flips by a step where rounding decides it: not these."""
    tool, model = bench_tool(), "pooltool"
    rows = golden_rows(tool, find_scene("any"), model, STEPS)
    cases = np.array([[float.fromhex(x) for x in (*row.params, *row.bodies)] for row in rows])
    want = tool.expect(cases, "euler", model, 1000)
    moved = cases.copy()
    moved[:, 9:15] *= 1 + 1e-14 * np.random.default_rng(3).uniform(-1, 1, (len(rows), 6))
    worst = errors_of(cases, tool.expect(moved, "euler", model, 1000), want).relative.max()
    print(f"{len(rows)} rows move by {worst:.2g} of the relative speed")
    assert len(rows) > 15 and worst < 1e-9
    assert not {row.kind for row in rows} & {"sticks"}


@pytest.mark.parametrize("scene", ["stun", "free", "arcade", "break"])
def test_every_kind_of_scene_can_be_vendored(scene, tmp_path) -> None:
    """Closed form, no table, fixed parameters, unequal masses: their files are made."""
    budget = find_scene(scene).max_error
    made = files_for(request_for("x86-64-v2", Goal(budget=budget), scene=scene))
    assert f"scene {scene}" in made["carom.h"] and "carom_collide_steps" not in made["carom.h"]


# ---- whole or not at all -----------------------------------------------------------------------


def test_what_fails_half_way_leaves_the_old_folder(tmp_path) -> None:
    made = vendored(tmp_path / "carom", request_for(TARGETS, STEPS))
    before = {p.name: p.read_bytes() for p in made.iterdir()}
    with pytest.raises(InputError, match="No space"), staged(made) as folder:
        write_files(folder, {"carom.h": "half"})
        raise OSError(28, "No space left on device")
    assert {p.name: p.read_bytes() for p in made.iterdir()} == before
    assert [p.name for p in tmp_path.iterdir()] == ["carom"]


def test_what_is_killed_half_way_leaves_the_old_folder(tmp_path) -> None:
    made = vendored(tmp_path / "carom", request_for(TARGETS, STEPS))
    before = {p.name: p.read_bytes() for p in made.iterdir()}
    child = os.fork()
    if child == 0:
        with staged(made) as folder:
            write_files(folder, {"carom.h": "half"})
            os._exit(9)
    os.waitpid(child, 0)
    assert {p.name: p.read_bytes() for p in made.iterdir()} == before


@pytest.mark.parametrize("in_one_step", [True, False])
def test_a_folder_is_replaced_whole(in_one_step, tmp_path, monkeypatch) -> None:
    """Exchanged where the system can, else moved aside; nothing stays behind."""
    if not in_one_step:
        monkeypatch.setattr(folder_room, "_exchange", lambda one, other: False)
    made = vendored(tmp_path / "carom", request_for(TARGETS, STEPS))
    with staged(made) as folder:
        write_files(folder, {"only.txt": "new\n"})
    assert [p.name for p in made.iterdir()] == ["only.txt"]
    assert [p.name for p in tmp_path.iterdir()] == ["carom"]


# ---- unchanged, edited, out of date ------------------------------------------------------------


def test_verify_says_unchanged(tmp_path) -> None:
    made = vendored(tmp_path / "carom", request_for(TARGETS, STEPS))
    found = compare(made, nowhere(tmp_path), {DEFAULT_IMPACT: bench_tool()})
    assert found.unchanged, found


@pytest.mark.parametrize("what", ["edited", "missing", "added", "manifest"])
def test_verify_says_edited_by_hand(what, tmp_path) -> None:
    made = vendored(tmp_path / "carom", request_for(TARGETS, STEPS))
    if what == "edited":
        (made / "carom_zen3.cpp").write_text((made / "carom_zen3.cpp").read_text() + "\n")
    elif what == "missing":
        (made / "LICENSE").unlink()
    elif what == "added":
        (made / "notes.txt").write_text("mine")
    else:
        text = (made / FILE).read_text()
        (made / FILE).write_text(text.replace('"bound": 1e-06', '"bound": 1e-09'))
    found = compare(made, nowhere(tmp_path), {DEFAULT_IMPACT: bench_tool()})
    print(found.by_hand)
    names = {"edited": "carom_zen3.cpp", "missing": "LICENSE", "added": "notes.txt"}
    assert [change.name for change in found.by_hand] == [names.get(what, FILE)]
    if what != "manifest":  # which cannot be told from another version's once it was edited
        assert found.outdated == ()


def test_verify_says_out_of_date_where_the_sources_have_changed(tmp_path, monkeypatch) -> None:
    made = vendored(tmp_path / "carom", request_for(TARGETS, STEPS))
    monkeypatch.setattr(package, "STRICT", ("-O1",))
    found = compare(made, nowhere(tmp_path), {DEFAULT_IMPACT: bench_tool()})
    print(found.outdated)
    assert found.by_hand == () and found.outdated == ("CMakeLists.txt: out of date",)


def test_verify_says_out_of_date_where_another_kernel_is_chosen_by_now(tmp_path) -> None:
    request = request_for(TARGETS, STEPS)
    made = vendored(tmp_path / "carom", request)
    record = record_for(request, "zen3")
    places = nowhere(tmp_path)
    for ratio, reasons in ((None, 0), (0.4, 1)):
        entry = record.model_copy(update={"ratio_to_baseline": ratio})
        chosen = Selection(
            impact="ball-ball", target="zen3", resolved="zen3", scene="any", kernels=[entry]
        )
        write_file(
            places.cache / "ball-ball" / "zen3" / "any" / SELECTION, chosen.text(), parents=True
        )
        assert stored_kernels(places, request, "zen3") == TargetKernels(entry)
        found = compare(made, places, {DEFAULT_IMPACT: bench_tool()})
        print(found.outdated)
        assert found.by_hand == () and len(found.outdated) == reasons


def test_a_stored_choice_for_batches_is_vendored_beside_that_for_single_calls(tmp_path) -> None:
    """Of several widths the fastest; a folder that has none of them is out of date."""
    request = request_for("zen3", STEPS)
    single = record_for(request, "zen3")
    wide = [
        record_for(request, "zen3", width).model_copy(update={"ratio_to_baseline": ratio})
        for width, ratio in ((2, 0.2), (4, 0.1))
    ]
    places = nowhere(tmp_path)
    stored = Selection(
        impact="ball-ball", target="zen3", resolved="zen3", scene="any", kernels=[single, *wide]
    )
    write_file(places.cache / "ball-ball" / "zen3" / "any" / SELECTION, stored.text(), parents=True)
    assert stored_kernels(places, request, "zen3") == TargetKernels(single, wide[1])
    made = vendored(tmp_path / "carom", request)
    found = compare(made, places, {DEFAULT_IMPACT: bench_tool()})
    print(found.outdated)
    assert wide[1].kernel in found.outdated[0]


def test_other_steps_take_the_choice_at_a_thousand_lanes_included(tmp_path) -> None:
    """The same loops with another N, verified with it, and stored."""
    thousand, request = (request_for("x86-64-v2", Goal(steps=n)) for n in (1000, 50))
    places, host = nowhere(tmp_path), read_host()
    base = [record_for(thousand, "x86-64-v2", width) for width in (1, 2)]
    stored = Selection(
        impact="ball-ball", target="x86-64-v2", resolved="x86-64-v2", scene="any", kernels=base
    )
    write_file(
        places.cache / "ball-ball" / "x86-64-v2" / "any" / SELECTION, stored.text(), parents=True
    )
    bench = Workbench(bench_tool(), CACHE.parent, {c.code: c for c in find_compilers()})
    made = kernels_for(places, request, "x86-64-v2", bench, host, 1.0)
    assert made.batch is not None
    for entry, old in ((made.single, base[0]), (made.batch, base[1])):
        print(f"{entry.kernel}: largest error {entry.max_rel_error:g} of the relative speed")
        assert entry.kernel == old.kernel.replace("-n1000-", "-n50-")
        assert entry.goal.steps == 50 and entry.max_rel_error > 0
    assert stored_kernels(places, request, "x86-64-v2") == made


def test_verify_refuses_what_is_no_vendored_folder(tmp_path) -> None:
    result = call("--verify", tmp_path)
    assert result.exit_code == 2 and "no manifest.json" in result.stderr
    (tmp_path / FILE).write_text('{"schema_version": 1}')
    result = call("--verify", tmp_path)
    print(result.stderr)
    assert result.exit_code == 2 and "key carom" in result.stderr
    result = call("--verify", tmp_path, "--prefix", "x")
    assert result.exit_code == 2 and "remove --prefix" in result.stderr


def test_verify_prints_the_state_and_exits_by_it(tmp_path) -> None:
    out = tmp_path / "carom"
    assert call("--target", "x86-64-v2", "--steps", 1000, "--out", out).exit_code == 0
    with (out / "carom.hpp").open("a") as stream:
        stream.write("// mine\n")
    result = call("--verify", out)
    print(result.stdout)
    assert result.exit_code == 1
    assert "carom.hpp: edited by hand" in result.stdout and "out of date" not in result.stdout


# ---- the dispatcher ----------------------------------------------------------------------------


def test_cpuid_tells_every_instruction_set_that_a_unit_may_use() -> None:
    used = {feature for target in targets().values() for feature in compiled_features(target)}
    assert used <= set(CPUID_BITS), used - set(CPUID_BITS)
    assert {cpu.target for cpu in KNOWN_CPUS} <= set(targets())


@pytest.mark.parametrize(
    ("names", "order", "wanted"),
    [
        ("x86-64-v2,zen3,x86-64-v3", (2, 1, 0), {"zen3": "zen3", "zen5": "x86-64-v3"}),
        ("zen3,x86-64-v2", (0, 1), {"sapphirerapids": "zen3", "zen2": "zen3"}),
        ("x86-64-v4,zen4,zen3", (0, 1, 2), {"zen5": "zen4", "skylake-avx512": "x86-64-v4"}),
    ],
)
def test_known_cpus_get_their_own_kernel_or_their_nearest_ancestors(names, order, wanted) -> None:
    request = request_for(names)
    assert preferred_order(request.targets) == tuple(request.targets[i] for i in order)
    known = dispatch_context(request).known
    assert len(known) == len(KNOWN_CPUS)
    for cpu, row in zip(KNOWN_CPUS, known, strict=True):
        print(cpu.target, "gets", row.target)
        assert row.target == wanted.get(cpu.target, row.target)


def test_two_folders_of_one_request_are_alike_whatever_the_place(tmp_path) -> None:
    request = request_for(TARGETS, STEPS)
    first = vendored(tmp_path / "a", request)
    files_for.cache_clear()
    second = vendored(tmp_path / "b" / "deep", request)
    assert {p.name: p.read_bytes() for p in first.iterdir()} == {
        p.name: p.read_bytes() for p in second.iterdir()
    }
    shutil.rmtree(second)
