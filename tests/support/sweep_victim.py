"""A sweep on made-up kernels that a test kills. It prints each record that it was told is kept."""

from __future__ import annotations

import sys
from pathlib import Path

from generator.choice.trials import Record
from generator.sweep.store import opened
from tests.support.sweep_lab import FIXED, FakeLab, plan, swept

ONLY = {"simd": ("scalar",), "store": ("named",), "fma": ("fma",), "branch": ("chosen",)}
ASKED = plan(FIXED, only=ONLY, exhaustive=True)


def main() -> None:
    with opened(Path(sys.argv[1])) as store:
        append = store.append

        def told(record: Record) -> None:
            append(record)
            print(f"kept {record.id}", flush=True)

        store.append = told  # type: ignore[method-assign]
        swept(store, FakeLab(seconds=0.01), ASKED)


if __name__ == "__main__":
    main()
