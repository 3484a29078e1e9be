"""The store of a sweep: one SQLite file to which records are appended, each durable at once."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from ..choice.trials import SCHEMA, Final, Record, Run, Trial, parse_record
from ..errors import InputError
from ..files import require_regular

FILE = "sweep.sqlite"
_APPLICATION = 0x6361726D  # "carm", in the file's header
_TABLE = """
CREATE TABLE IF NOT EXISTS record (
  id TEXT PRIMARY KEY,      -- hash of the document: the same record is never stored twice
  kind TEXT NOT NULL,       -- run, trial, final
  key TEXT NOT NULL,        -- the same question has the same key
  made_at TEXT NOT NULL,
  document TEXT NOT NULL    -- JSON, see docs/sweep.md
) STRICT
"""
_INDEX = "CREATE INDEX IF NOT EXISTS record_by_key ON record (kind, key)"


def default_store(cache: Path) -> Path:
    """Where a sweep keeps its records unless it is told another place."""
    return cache / FILE


class ResultStore:
    """Records in the order in which they were appended. Make one with `opened` or `read_only`."""

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path = path
        self._connection = connection

    def append(self, record: Record) -> None:
        """Keep a sealed record, once; it is on the disk when this returns."""
        body: dict[str, Any] = record.model_dump(mode="json")
        row = (record.id, body["kind"], record.key, record.made_at, record.model_dump_json())
        try:
            with self._connection:
                self._connection.execute("INSERT OR IGNORE INTO record VALUES (?, ?, ?, ?, ?)", row)
        except sqlite3.Error as error:
            raise InputError(f"{self.path}: cannot be written: {error}") from None

    def records(self, kind: str = "%") -> Iterator[Run | Trial | Final]:
        """All records of a kind, oldest first. Raises InputError naming one that does not read."""
        query = "SELECT id, document FROM record WHERE kind LIKE ? ORDER BY rowid"
        for identity, document in self._rows(query, kind):
            try:
                yield parse_record(document)
            except ValueError as error:
                first = str(error).splitlines()[-1].strip()
                raise InputError(
                    f"{self.path}: record {identity}: {first}; expected schema {SCHEMA}: "
                    "name another --store, or remove it to begin anew"
                ) from None

    def runs(self) -> list[Run]:
        return [record for record in self.records("run") if isinstance(record, Run)]

    def trials(self) -> list[Trial]:
        return [record for record in self.records("trial") if isinstance(record, Trial)]

    def finals(self) -> list[Final]:
        return [record for record in self.records("final") if isinstance(record, Final)]

    def _rows(self, query: str, *values: object) -> list[tuple[str, str]]:
        try:
            return self._connection.execute(query, values).fetchall()
        except sqlite3.DatabaseError as error:
            raise InputError(f"{self.path}: not a sweep's store: {error}") from None


def _connect(path: Path, mode: str) -> sqlite3.Connection:
    # Also a reader opens it to be written to: it may have to roll back what a killed sweep began.
    uri = f"{path.resolve().as_uri()}?mode={mode}"
    connection = sqlite3.connect(uri, uri=True, timeout=30)
    try:
        known = connection.execute("PRAGMA application_id").fetchone()[0]
        if known not in (0, _APPLICATION):
            raise sqlite3.DatabaseError("made by another program")
        if mode == "rwc":
            connection.execute("PRAGMA synchronous = FULL")
            connection.execute(f"PRAGMA application_id = {_APPLICATION}")
            with connection:
                connection.execute(_TABLE)
                connection.execute(_INDEX)
        elif known != _APPLICATION:
            raise sqlite3.DatabaseError("empty")
        else:
            connection.execute("PRAGMA query_only = ON")
    except sqlite3.DatabaseError:
        connection.close()
        raise
    return connection


@contextmanager
def opened(path: Path) -> Iterator[ResultStore]:
    """A store to append to, made where there is none, for one sweep at a time.

    Raises InputError where another sweep has it, or where the file is no store.
    """
    lock = FileLock(f"{path}.lock")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        require_regular(path)
        lock.acquire(timeout=0)
    except Timeout:
        raise InputError(
            f"{path}: another sweep is writing to it; wait for it or name another --store"
        ) from None
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from None
    try:
        with _connection(path, "rwc") as connection:
            yield ResultStore(path, connection)
    finally:
        lock.release()


@contextmanager
def read_only(path: Path) -> Iterator[ResultStore]:
    """A store to read, also while a sweep appends. InputError where there is none."""
    if not path.is_file():
        raise InputError(f"{path}: no store of a sweep; make one with ./gen sweep --store {path}")
    with _connection(path, "rw") as connection:
        yield ResultStore(path, connection)


@contextmanager
def _connection(path: Path, mode: str) -> Iterator[sqlite3.Connection]:
    try:
        connection = _connect(path, mode)
    except sqlite3.Error as error:
        raise InputError(f"{path}: not a sweep's store: {error}") from None
    try:
        yield connection
    finally:
        connection.close()


def merge(sources: Iterable[Path], out: Path) -> dict[Path, int]:
    """Records of all sources, each once, oldest first, into a new or an existing store.

    Returns how many records each source added. Raises InputError, before anything is written, where
    a source is no store.
    """
    found: dict[Path, list[Run | Trial | Final]] = {}
    for path in sources:
        with read_only(path) as store:
            found[path] = list(store.records())
    added = dict.fromkeys(found, 0)
    with opened(out) as store:
        known = {record.id for record in store.records()}
        everything = [(path, record) for path in found for record in found[path]]
        for path, record in sorted(everything, key=lambda each: each[1].made_at):
            if record.id not in known:
                store.append(record)
                known.add(record.id)
                added[path] += 1
    return added
