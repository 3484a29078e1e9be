"""The exact kernels of generated/ as they are now: verified and searched for errors anew.

`.venv/bin/python tools/search_generated.py` rewrites what selection.json says of errors, after a
change of the sources that made the texts anew (`./gen --update`). Which kernel is chosen stays, and
so do its times. Kernels that this CPU cannot run are left as they are, and named. Exit status 1
where a kernel fails or a search finds it over.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from generator.api.session import Session
from generator.choice.entries import found_errors
from generator.choice.folder import checked_selection, folders, write_folder
from generator.choice.kernel import Rejected
from generator.choice.lookup import with_compiler_found
from generator.choice.selection import Selected
from generator.choice.sought import sought
from generator.choice.workbench import Workbench
from generator.evidence.timing.bench_tool import ROOT
from generator.registry.question import find_impact
from generator.targets.host import read_host
from generator.targets.target import find_target


def searched(bench: Workbench, entry: Selected) -> Selected | str:
    """The entry with what is found of its kernel now; a text: why the kernel fails."""
    variant = with_compiler_found(entry.variant, dict(bench.compilers))
    found = bench.check(bench.emit(variant, find_target(variant.target)))
    if not isinstance(found, Rejected):
        found = bench.verifier.verify_at_worst(found)
    if isinstance(found, Rejected):
        return found.text
    told = sought(bench, found, [])
    search = "" if told is None else told.told() + ("" if told.held else f"; case {told.case}")
    return entry.model_copy(update={**found_errors(found.verdict), "search": search})


def main() -> int:
    """Each folder is written when all of its kernels are searched."""
    failed = 0
    for folder in folders(ROOT / "generated"):
        selection = checked_selection(folder)
        if selection is None or not read_host().runs(find_target(selection.resolved)):
            print(f"{folder}: left as it is, this CPU does not run it")
            continue
        entries = []
        impact, target = find_impact(selection.impact), find_target(selection.resolved)
        with Session().workbench(target=target, impact=impact) as bench:
            for entry in selection.kernels:
                exact = entry.variant.stepper.budget is not None
                made = searched(bench, entry) if exact else entry
                told = made if isinstance(made, str) else made.search
                failed += isinstance(made, str) or told.startswith("OVER")
                if exact:
                    print(f"{entry.question}: {told}", flush=True)
                entries.append(entry if isinstance(made, str) else made)
        write_folder(folder, selection.model_copy(update={"kernels": entries}))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
