"""Files of records: JSON lines in one order, whoever wrote them. A damaged line is named."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from ...errors import InputError
from ...files import write_file
from .record import TimingRecord

FOLDER, SUFFIX = "timings", ".jsonl"


@dataclass(frozen=True)
class RecordFile:
    """What a file held: the records that read, and a line for each that does not."""

    records: tuple[TimingRecord, ...]
    damaged: tuple[str, ...]  # file:line: what is wrong


def timings_path(root: Path, cpu: str) -> Path:
    """The committed file of a CPU."""
    return root / FOLDER / f"{cpu}{SUFFIX}"


def read_records(path: Path) -> RecordFile:
    """The records of a file. Raises InputError where it cannot be read at all."""
    try:
        text = path.read_bytes().decode("utf-8", errors="replace")
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}; expected JSON lines") from None
    records, damaged = [], []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip():
            continue
        try:
            records.append(TimingRecord.model_validate_json(line))
        except ValidationError as error:
            damaged.append(f"{path}:{number}: {_reason(error)}; the line is skipped")
    return RecordFile(tuple(records), tuple(damaged))


def _reason(error: ValidationError) -> str:
    first = error.errors()[0]
    where = ".".join(str(part) for part in first["loc"])
    return f"{where}: {first['msg']}" if where else str(first["msg"])


def union(*groups: Iterable[TimingRecord]) -> tuple[TimingRecord, ...]:
    """Each record once, in the order of a file."""
    lines = {record.line(): record for group in groups for record in group}
    order = sorted(lines, key=lambda line: (lines[line].question, lines[line].recipe, line))
    return tuple(lines[line] for line in order)


def write_records(path: Path, records: Iterable[TimingRecord]) -> int:
    """The file anew, whole or not at all. How many records it has."""
    lines = [f"{record.line()}\n" for record in union(records)]
    write_file(path, "".join(lines), parents=True)
    return len(lines)
