"""Cases that a kernel once failed, kept to the last bit: tests/data/hard_cases.csv."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ...files import write_file
from ...impacts.ball_ball.evidence import EVIDENCE
from ...impacts.ball_ball.evidence.measure import CASE_NAMES
from ..verification.errors import Array
from ..verification.hard_cases import load_hard

FILE = EVIDENCE.hard_cases


def hexfloats(case: Array) -> str:
    """A case to the last bit, as C and Python read it."""
    return " ".join(
        f"{name}={value.hex()}" for name, value in zip(CASE_NAMES, map(float, case), strict=True)
    )


def csv_row(kind: str, case: Array, number: int = 0) -> str:
    """A case in the columns of reference/inputs.csv; the shortest decimals that read back."""
    return ",".join([str(number), kind, *(repr(float(value)) for value in case)])


CSV_HEADER = ",".join(["id", "kind", *CASE_NAMES])


def keep(found: Sequence[tuple[str, Array]], path: Path = FILE) -> int:
    """Adds cases (kind, row) that are not there yet; how many were new."""
    _, rows = load_hard(path, CASE_NAMES)
    known = {tuple(row) for row in rows}
    new = [(kind, row) for kind, row in found if tuple(row) not in known]
    lines = [",".join([kind, *(float(value).hex() for value in row)]) + "\n" for kind, row in new]
    write_file(path, path.read_text("utf-8") + "".join(lines))
    return len(new)
