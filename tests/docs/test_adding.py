"""docs/adding-a-*.md: the numbers of files that they state, and that so many are enough."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace

import pytest

import generator.impacts.ball_ball.candidates as candidates
import generator.impacts.ball_ball.presets as presets
import generator.registry.axes as axes_room
import generator.targets.host as host
import generator.targets.target as target_room
from generator.choice.folder import differences
from generator.emission.kernel_source import emit
from generator.evidence.records.files import read_records
from generator.impacts.ball_ball.presets import Preset, find_preset
from generator.registry.names import name_of, variant_of
from generator.registry.variant import fixed_steps, make_variant
from generator.targets.target import find_target, targets
from tests.support.contests import fixed_step_candidates
from tests.support.kernels import ROOT

GUIDES = sorted((ROOT / "docs").glob("adding-a-*.md"))
STEPPER = fixed_steps(1000)


@pytest.mark.parametrize("guide", GUIDES, ids=lambda path: path.stem)
def test_guides_name_as_many_files_as_they_say_and_each_is_there(guide) -> None:
    sections = re.split(r"^## ", guide.read_text("utf-8"), flags=re.MULTILINE)[1:]
    counted = 0
    for section in sections:
        title = section.splitlines()[0]
        stated = re.search(r"(\d+) files?$", title)
        if stated is None:
            continue
        table = section.split("one more file:")[0]
        files = re.findall(r"^\| `([^`]+)` \|", table, re.MULTILINE)
        print(f"{guide.stem}: {title}: {files}")
        assert int(stated[1]) == len(files), title
        known = [name for name in files if "NAME" not in name]
        assert all((ROOT / name).exists() for name in known), title
        counted += 1
    assert counted, f"{guide}: no section states a number of files"


def test_there_is_a_guide_for_each_of_the_four() -> None:
    stems = {guide.stem for guide in GUIDES}
    assert {f"adding-a-{what}" for what in ("variant", "stepper", "target", "scene")} <= stems


def test_a_target_is_added_in_one_file(monkeypatch) -> None:
    """The table of docs/adding-a-target.md as it stands there, and a kernel for it."""
    guide = (ROOT / "docs" / "adding-a-target.md").read_text("utf-8")
    table = guide.split("```toml\n")[1].split("```")[0]
    (name,) = tomllib.loads(table)
    own = (ROOT / "generator" / "targets" / "targets.toml").read_text("utf-8")
    rows = target_room.load_rows(own + "\n" + table, "both")
    known = {row: target_room._inherit(row, rows) for row in rows}
    assert {row: known[row] for row in targets()} == targets()
    monkeypatch.setattr(target_room, "targets", lambda: known)
    assert find_target(name).has("avx2") and find_target(name).ancestors[0] == "x86-64-v3"
    made = make_variant(name, "any", "pooltool", STEPPER, fma="fma")
    assert variant_of(name_of(made)) == made
    assert "avx2,fma" in emit(made).source


@pytest.mark.parametrize(("family", "lanes"), [("all", False), ("exact", True)])
def test_an_axis_with_a_default_renames_nothing_and_changes_no_committed_byte(
    monkeypatch: pytest.MonkeyPatch, family: str, lanes: bool
) -> None:
    """Files of generated/, their names, their texts and records: the registry alone is patched."""
    choices = (axes_room.Choice("plain", "as it was"), axes_room.Choice("fancy", "otherwise"))
    added = axes_room.Axis("finish", "a decision that is new", choices, family, lanes)
    known = [r for path in (ROOT / "timings").glob("*.jsonl") for r in read_records(path).records]
    before = {record.kernel: variant_of(record.kernel).options for record in known}
    monkeypatch.setattr(axes_room, "AXES", (added, *axes_room.AXES))
    folder = ROOT / "generated" / "ball-ball" / "zen3" / "any"
    assert differences(folder) == []
    grown = 0
    for name, options in before.items():
        now = variant_of(name)
        assert name_of(now) == name
        grown += now.options != options
        assert dict(options).items() <= dict(now.options).items()
    print(f"{grown} of {len(before)} kernels have the axis")
    wide = variant_of("ball-ball/zen3/any/pooltool-e1m06-x4 dp54 lane_root=inv")
    fancy = wide.with_options(finish="fancy")
    assert grown and name_of(fancy).startswith(f"{wide.question} dp54 finish=fancy")
    assert variant_of(name_of(fancy)) == fancy


def test_a_cpu_is_made_known_in_one_file(monkeypatch) -> None:
    flags = " ".join(sorted(find_target("x86-64-v3").features)).replace("sse4.", "sse4_")
    fields = ("vendor_id: GenuineIntel", "cpu family: 6", "model: 183", f"flags: {flags}")
    text = "\n".join(fields).replace(" bmi ", " bmi1 ").replace("lzcnt", "abm")
    text = text.replace("sse3", "pni").replace("spni", "ssse3")
    if not host.read_host(text).runs(find_target("x86-64-v3")):
        pytest.skip("not an x86-64 machine")
    assert not host.read_host(text).exact
    row = host.KnownCpu("GenuineIntel", 6, 183, "", "x86-64-v3")
    monkeypatch.setattr(host, "KNOWN_CPUS", (*host.KNOWN_CPUS, row))
    assert host.read_host(text).exact and host.read_host(text).target.name == "x86-64-v3"


def test_a_combination_is_added_in_one_file(monkeypatch) -> None:
    row = {"state": "full", "reuse": "recompute", "roots": "two", "rsqrt": "est2"}
    known = candidates.CANDIDATES
    monkeypatch.setattr(candidates, "CANDIDATES", replace(known, fixed=(*known.fixed, row)))
    target = find_target("x86-64-v3")
    found = fixed_step_candidates(target, "any", "pooltool", 1000, ["gcc"])
    mine = [v for v in found if row.items() <= dict(v.options).items()]
    print([name_of(v) for v in mine])
    assert len(mine) == 1


def test_a_preset_is_added_in_one_file(monkeypatch) -> None:
    added = Preset("mine", "two roots by estimate", {"roots": "two", "rsqrt": "est2"})
    monkeypatch.setattr(presets, "PRESETS", (*presets.PRESETS, added))
    options = find_preset("mine").options
    assert emit(make_variant("zen3", "any", "pooltool", STEPPER, **options)).counts.flops > 40
