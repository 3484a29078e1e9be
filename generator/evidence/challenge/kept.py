"""Cases that a kernel once failed, kept to the last bit in a file of the impact."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ...files import write_file
from ..verification.errors import Array
from ..verification.hard_cases import load_hard


def hexfloats(case: Array, names: Sequence[str]) -> str:
    """A case to the last bit, as C and Python read it."""
    return " ".join(
        f"{name}={value.hex()}" for name, value in zip(names, map(float, case), strict=True)
    )


def csv_row(kind: str, case: Array, number: int = 0) -> str:
    """A case in the columns of inputs.csv; the shortest decimals that read back."""
    return ",".join([str(number), kind, *(repr(float(value)) for value in case)])


def csv_header(names: Sequence[str]) -> str:
    return ",".join(["id", "kind", *names])


def keep(found: Sequence[tuple[str, Array]], path: Path, names: Sequence[str]) -> int:
    """Adds cases (kind, row) that are not there yet; how many were new."""
    _, rows = load_hard(path, names)
    known = {tuple(row) for row in rows}
    new = [(kind, row) for kind, row in found if tuple(row) not in known]
    lines = [",".join([kind, *(float(value).hex() for value in row)]) + "\n" for kind, row in new]
    write_file(path, path.read_text("utf-8") + "".join(lines))
    return len(new)
