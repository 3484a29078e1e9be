"""Fuzzers of what reads users' text: python fuzz/parsers.py READER [libFuzzer options].

Whatever comes in, a reader gives a value or raises the one error that it documents.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["generator", "tomllib", "csv"]):
    from generator.api.case_files import read_cases
    from generator.choice.selection import FILE, read_selection
    from generator.errors import InputError
    from generator.impacts.ball_ball.scene import parse_scene
    from generator.registry.names import name_of, variant_of
    from generator.targets.target import load_rows

SCRATCH = Path(tempfile.mkdtemp(prefix="carom-fuzz-", dir="/dev/shm"))


def _text(data: bytes) -> str:
    return data.decode("utf-8", "replace")


def scene(data: bytes) -> None:
    parse_scene(_text(data), "scene.toml")


def targets(data: bytes) -> None:
    load_rows(_text(data), "targets.toml")


def cases(data: bytes) -> None:
    path = SCRATCH / "cases.csv"
    path.write_bytes(data)
    table = read_cases(path)
    assert table.rows.shape == (len(table.ids), 24)


def selection(data: bytes) -> None:
    (SCRATCH / FILE).write_bytes(data)
    read_selection(SCRATCH)


def names(data: bytes) -> None:
    text = _text(data)
    try:
        variant = variant_of(text)
    except ValueError:
        return
    assert variant_of(name_of(variant)) == variant


READERS: dict[str, Callable[[bytes], None]] = {
    read.__name__: read for read in (scene, targets, cases, selection, names)
}


def main(arguments: list[str]) -> int:
    """Fuzz the reader that the first argument names; 2 where there is none."""
    if len(arguments) < 2 or arguments[1] not in READERS:
        print(f"name a reader: {', '.join(READERS)}", file=sys.stderr)
        return 2
    read = READERS[arguments[1]]

    def once(data: bytes) -> None:
        try:
            read(data)
        except InputError as error:
            assert "\n" not in str(error), "an error of more than one line"

    atheris.Setup([arguments[0], *arguments[2:]], once)
    atheris.Fuzz()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
