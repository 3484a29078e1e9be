"""The store of a sweep: what is appended stays, once, and reads back as it was."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest

from generator.choice.trials import Trial, trial_key
from generator.errors import InputError
from generator.evidence.records.code import digest
from generator.sweep.store import merge, opened, read_only
from tests.support.sweep_records import DEPENDS, trial


def stored(path: Path, *trials: Trial) -> Path:
    with opened(path) as store:
        for each in trials:
            store.append(each)
    return path


def test_records_read_back_as_they_were_in_the_order_they_were_appended(tmp_path: Path) -> None:
    written = [trial(ratio) for ratio in (0.5, 1 / 3, 0.4)]
    path = stored(tmp_path / "s.sqlite", *written)
    with read_only(path) as store:
        assert store.trials() == written
        assert store.runs() == store.finals() == []
    assert {p.name for p in tmp_path.iterdir()} <= {"s.sqlite", "s.sqlite.lock"}


def test_an_id_is_the_hash_of_the_record_and_the_same_record_is_kept_once(tmp_path: Path) -> None:
    one = trial(0.5)
    assert one.id == digest(one.model_dump(mode="json", exclude={"id"})) == trial(0.5).id
    assert one.id != trial(0.6).id
    with read_only(stored(tmp_path / "s.sqlite", one, trial(0.5))) as store:
        assert store.trials() == [one]


def test_the_key_follows_from_what_a_figure_depends_on_and_the_rung_alone() -> None:
    assert trial(0.5, rsqrt="inv").key == trial(0.7, rsqrt="est1", new="axis").key
    keys = {trial_key(DEPENDS, 0), trial_key(DEPENDS, 1)}
    for field, value in DEPENDS.model_dump().items():
        other = "batch" if field == "call" else value + "x"
        changed = DEPENDS.model_copy(update={field: other})
        assert changed.differences(DEPENDS) == (field,)
        keys.add(trial_key(changed, 0))
    assert len(keys) == 2 + len(DEPENDS.model_dump())


def test_stores_merge_into_one_with_each_record_once_whatever_the_order(tmp_path: Path) -> None:
    a = stored(tmp_path / "a.sqlite", trial(0.1), trial(0.2))
    b = stored(tmp_path / "b.sqlite", trial(0.2), trial(0.3))
    assert merge([a, b], tmp_path / "ab.sqlite") == {a: 2, b: 1}
    assert merge([b, a], tmp_path / "ba.sqlite") == {b: 2, a: 1}
    assert merge([a, b], tmp_path / "ab.sqlite") == {a: 0, b: 0}
    ids = []
    for name in ("ab.sqlite", "ba.sqlite"):
        with read_only(tmp_path / name) as store:
            ids.append(sorted(record.id for record in store.records()))
    assert ids[0] == ids[1] == sorted(trial(r).id for r in (0.1, 0.2, 0.3))


def test_what_is_no_store_is_named_and_left_as_it_was(tmp_path: Path) -> None:
    text, other = tmp_path / "text", tmp_path / "other.sqlite"
    text.write_text("no database at all, but long enough to be looked at" * 9)
    with sqlite3.connect(other) as connection:
        connection.execute("PRAGMA application_id = 7")
        connection.execute("CREATE TABLE record (x)")
    before = text.read_bytes(), other.read_bytes()
    for path in (text, other, tmp_path / "missing"):
        with pytest.raises(InputError, match=str(path)), read_only(path):
            pass
        with pytest.raises(InputError, match=str(path)):
            merge([path], tmp_path / "out.sqlite")
    for path in (text, other):
        with pytest.raises(InputError, match=str(path)), opened(path):
            pass
    assert (text.read_bytes(), other.read_bytes()) == before
    assert not (tmp_path / "out.sqlite").exists()


def test_a_record_with_a_field_too_many_is_named(tmp_path: Path) -> None:
    path = stored(tmp_path / "s.sqlite", trial(0.5))
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE record SET document = json_set(document, '$.colour', 'red')")
    with read_only(path) as store, pytest.raises(InputError, match=trial(0.5).id):
        store.trials()


def test_a_store_has_one_writer_and_any_readers(tmp_path: Path) -> None:
    path = tmp_path / "s.sqlite"
    with opened(path) as store:
        store.append(trial(0.5))
        with read_only(path) as reader:
            assert len(reader.trials()) == 1
        with pytest.raises(InputError, match="another sweep"), opened(path):
            pass
