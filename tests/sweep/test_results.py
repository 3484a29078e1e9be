"""gen results: records out of stores, into files, merged, and made by a refresh that is killed."""

from __future__ import annotations

import random
import signal
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from generator.api import Session
from generator.choice.trials import Trial
from generator.cli.main import gen
from generator.evidence.records.files import read_records, timings_path
from generator.registry.names import variant_of
from generator.sweep.exporting import exported
from generator.sweep.store import opened, read_only
from tests.support.sweep_lab import BATCH, EXACT, FIXED, FakeLab, plan, swept
from tests.sweep.test_sweep_kills import run_and_kill

ROOT = Path(__file__).parents[2]
ZEN3 = timings_path(ROOT, "zen3")


def call(*arguments: object, session: Session | None = None) -> Result:
    return CliRunner().invoke(gen, ["results", *map(str, arguments)], obj=session)


def part(path: Path, start: int, stop: int) -> Path:
    lines = ZEN3.read_text("utf-8").splitlines()[start:stop]
    path.write_text("".join(f"{line}\n" for line in lines), "utf-8")
    return path


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("swept") / "s.sqlite"
    with opened(path) as made:
        swept(made, FakeLab(), plan(FIXED, BATCH, EXACT, trials=48))
    return path


def test_a_merge_of_files_is_the_same_in_either_order_and_done_again(tmp_path: Path) -> None:
    a, b = part(tmp_path / "a.jsonl", 0, 300), part(tmp_path / "b.jsonl", 200, 530)
    one, two = tmp_path / "one.jsonl", tmp_path / "two.jsonl"
    assert call("merge", a, b, "--out", one).exit_code == 0
    assert call("merge", b, a, "--out", two).exit_code == 0
    assert one.read_bytes() == two.read_bytes() == ZEN3.read_bytes()
    again = call("merge", a, b, "--out", one)
    assert "a.jsonl: 0 records added" in again.stdout.replace("\n", "")
    assert one.read_bytes() == ZEN3.read_bytes()


def test_a_damaged_line_of_a_merge_is_named_and_the_rest_is_used(tmp_path: Path) -> None:
    a, b = part(tmp_path / "a.jsonl", 0, 4), part(tmp_path / "b.jsonl", 4, 8)
    a.write_text(a.read_text("utf-8") + '{"question": "ball-ball/zen3/an', "utf-8")
    done = call("merge", a, b, "--out", tmp_path / "c.jsonl")
    print(done.stderr)
    assert done.exit_code == 0
    assert f"carom: {a}:5: " in done.stderr and "skipped" in done.stderr
    assert len(read_records(tmp_path / "c.jsonl").records) == 8


def test_stores_and_files_do_not_mix(tmp_path: Path, store: Path) -> None:
    refused = call("merge", store, ZEN3, "--out", tmp_path / "c.jsonl")
    assert refused.exit_code == 2 and "do not mix" in refused.stderr
    assert not (tmp_path / "c.jsonl").exists()


def test_an_export_holds_one_record_of_each_kernel_that_was_timed(
    tmp_path: Path, store: Path
) -> None:
    out = tmp_path / "zen3.jsonl"
    done = call("export", "--cpu", "zen3", "--store", store, "--out", out)
    assert done.exit_code == 0, done.stderr
    records = read_records(out).records
    with read_only(store) as kept:
        trials, finals = kept.trials(), kept.finals()
    names = {t.subject.name for t in trials if t.times is not None}
    assert len(records) == len({r.kernel for r in records}) == len(names)
    in_finals = sum(len(final.finalists) for final in finals)
    assert sum("final" in r.origin for r in records) == in_finals > 0
    assert {r.cpu.text for r in records} == {"made up (zen3)"}
    before = out.read_bytes()
    again = call("export", "--cpu", "zen3", "--store", store, "--out", out)
    assert "0 of them new" in again.stdout and out.read_bytes() == before
    assert call("export", "--cpu", "zen4", "--store", store, "--out", tmp_path / "n").exit_code == 0


def test_an_import_adds_each_record_to_the_file_of_its_cpu(tmp_path: Path) -> None:
    here = Session(root=tmp_path)
    a = part(tmp_path / "a.jsonl", 0, 10)
    mixed = a.read_text("utf-8").replace("zen3", "zen4", 1).replace('"target":"zen3"', "X", 1)
    a.write_text(mixed.replace("X", '"target":"zen4"'), "utf-8")
    done = call("import", a, session=here)
    assert done.exit_code == 0, done.stderr
    sizes = [len(read_records(timings_path(tmp_path, cpu)).records) for cpu in ("zen3", "zen4")]
    assert sizes == [9, 1]
    assert "0 of 9 records were new" in call("import", a, session=here).stdout


def test_kill_9_during_a_refresh_loses_nothing_that_was_timed(tmp_path: Path) -> None:
    place, out = tmp_path / "r.sqlite", tmp_path / "zen3.jsonl"
    command = [sys.executable, "-P", "-m", "tests.support.refresh_victim", str(place), str(out)]
    moments, told, hit = random.Random(3), set[str](), 0
    for number in range(4):
        life = run_and_kill(command, moments.uniform(0.2, 1.2))
        told |= {line.split()[1] for line in life.lines if line.startswith("kept ")}
        with read_only(place) as store:
            records = list(store.records())
        assert told <= {record.id for record in records}, "told to be kept, and gone"
        hit += life.code == -signal.SIGKILL
        print(f"kill {number + 1}: {len(records)} records, {life.code}")
    assert hit >= 3
    with read_only(place) as store:
        timed = [t for t in store.trials() if t.times is not None]
        before = {r.basis.source for r in exported(store, "zen3").records}
    assert before == {t.depends.source[:16] for t in timed if t.depends is not None}
    assert run_and_kill(command, None).code == 0
    after = read_records(out).records
    assert before <= {r.basis.source for r in after}
    with read_only(place) as store:
        lowest = [t.key for t in store.trials() if isinstance(t, Trial) and t.rung == 0]
    assert len(lowest) == len(set(lowest)), "timed twice"
    assert {variant_of(r.kernel).model for r in after} == {"pooltool", "mathavan2014"}
    assert {r.cpu.model for r in after} == {1}


def test_a_refresh_for_another_cpu_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    refused = call("refresh", "--cpu", "neoverse-v1")
    assert refused.exit_code == 2
    assert "never the target's" in refused.stderr
