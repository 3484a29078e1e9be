"""Keeps what `cmake --build --preset default` made where ./gen and the tests look for it:

    python tools/keep_bench.py

The preset is optimised as they want it, so that they need not build carom_bench again.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from generator.evidence.timing.bench_tool import ROOT, keep_tool, kept_tool
from generator.files import require_cache
from generator.impacts.registry import IMPACTS
from generator.places import cache_folder

BUILT = ROOT / "build" / "default" / "bench"


def main() -> int:
    cache = cache_folder()
    require_cache(cache)
    for impact in IMPACTS:
        kept = kept_tool(cache, impact)
        if not kept.exists():
            keep_tool(BUILT / f"carom_bench_{impact.folder}", kept)
            print(f"{kept.name}: kept")
    return 0


if __name__ == "__main__":
    sys.exit(main())
