"""A refresh on made-up kernels that a test kills. It prints each record that it was told is kept.

Arguments: the store and the file of records.
"""

from __future__ import annotations

import sys
from pathlib import Path

from generator.choice.trials import Record
from generator.sweep.ledger import Ledger, new_run
from generator.sweep.refresh import add_exported, contests_of, refresh
from generator.sweep.store import opened
from tests.support.sweep_lab import FakeLab, plan

MODELS = ("pooltool", "mathavan2014")
ASKED = plan(*contests_of("zen3", "any", 1000, (1e-6,)), trials=24)


def main() -> None:
    with opened(Path(sys.argv[1])) as store:
        append = store.append

        def told(record: Record) -> None:
            append(record)
            print(f"kept {record.id}", flush=True)

        store.append = told  # type: ignore[method-assign]
        lab = FakeLab(seconds=0.005)
        cpuid = ("AuthenticAMD", 25, 1)
        run = new_run("a test", 1, lab.cpu, "zen3", lab.compilers, cpuid)
        refresh(
            ASKED,
            MODELS,
            lab,
            Ledger(store, run),
            lambda progress: None,
            lambda model: print(add_exported(store, "zen3", Path(sys.argv[2]), print)),
        )


if __name__ == "__main__":
    main()
