"""What memory takes of large batches: `.venv/bin/python tools/memory.py [--lanes N]`

A batch that the caches hold, one that they do not, and a loop that only reads and writes the same
columns block by block, in turn and by the thread's CPU time. Least of the rounds.
"""

from __future__ import annotations

import argparse
import ctypes
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from generator.impacts.ball_ball.evidence import EVIDENCE
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.build import build_library
from tests.support.exact_kernels import built, exact_variant
from tests.support.kernels import CACHE, bench_tool, compiler_of

SMALL, LARGE = 4096, 1_000_000
COLUMNS, CHANGED = 18, 12  # of a batch, beside u_b; u_b, columns and results are doubles
BYTES = 8 * (1 + COLUMNS + CHANGED)
COPY = """
#include <cstddef>
extern "C" std::size_t carom_probe_batch(const double*, const double* u_b, std::size_t n,
                                         const double* const in[18], double* const out[12],
                                         unsigned char*) {
  for (std::size_t first = 0; first + 64 <= n; first += 64) {
    double sum[64];
    for (int i = 0; i < 64; ++i) sum[i] = u_b[first + i];
    for (int k = 0; k < 18; ++k) {
      for (int i = 0; i < 64; ++i) sum[i] += in[k][first + i];
    }
    for (int k = 0; k < 12; ++k) {
      for (int i = 0; i < 64; ++i) out[k][first + i] = sum[i];
    }
  }
  return n;
}
"""


def _apart(columns: int, count: int):
    """Columns that do not begin at the same place of a page, where they would share cache sets."""
    return np.zeros((columns, count + 72))[:, :count]


class Batch:
    """Cases over and over, as many as asked for."""

    def __init__(self, cases, count: int) -> None:
        doubles = ctypes.POINTER(ctypes.c_double)
        rows = np.resize(cases, (count, cases.shape[1]))
        self.columns = _apart(COLUMNS, count)
        self.columns[:] = rows[:, 6:].T
        self.own = np.ascontiguousarray(rows[:, 4])
        self.params = np.ascontiguousarray(cases[0, :6])
        self.results = _apart(CHANGED, count)
        self.status = np.zeros(count, dtype=np.uint8)
        self.given = (doubles * COLUMNS)(*(c.ctypes.data_as(doubles) for c in self.columns))
        self.to = (doubles * CHANGED)(*(c.ctypes.data_as(doubles) for c in self.results))
        self.count = count

    def ns(self, library: ctypes.CDLL) -> float:
        """Of a collision, in one call."""
        began = time.thread_time_ns()
        library.carom_probe_batch(
            self.params.ctypes.data_as(ctypes.c_void_p),
            self.own.ctypes.data_as(ctypes.c_void_p),
            ctypes.c_size_t(self.count),
            self.given,
            self.to,
            self.status.ctypes.data_as(ctypes.c_void_p),
        )
        return (time.thread_time_ns() - began) / self.count


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--lanes", type=int, default=8)
    parser.add_argument("--target", default="", help="default: this machine's")
    parser.add_argument("--compiler", default="clang")
    parser.add_argument("--rounds", type=int, default=15)
    arguments = parser.parse_args()
    ways = {"numbers": "float", "interleave": "s2", "lane_root": "est1", "lane_tiers": "fixed"}
    target = find_target(arguments.target) if arguments.target else read_host().target
    made = exact_variant("mathavan2014", 1e-6, arguments.compiler, target=target)
    made = made.in_lanes(arguments.lanes, **ways)
    compiler = compiler_of(made)
    flags = ("-std=c++17", "-O3", "-march=native")
    copy = build_library({"copy.cpp": COPY}, (), compiler, flags, CACHE, "copy").path
    libraries = {str(made.recipe): built([made])[0], "reads and writes alone": copy}
    cases = bench_tool().make_cases(7735, SMALL, fixed=EVIDENCE.shared).rows
    for name, path in libraries.items():
        library = ctypes.CDLL(str(path))
        least = [
            min(batch.ns(library) for _ in range(arguments.rounds))
            for batch in (Batch(cases, SMALL), Batch(cases, LARGE))
        ]
        print(f"{name}: {least[0]:.1f} ns of {SMALL}, {least[1]:.1f} of {LARGE}")
        print(f"  {least[1] / least[0]:.2f} times as long; {BYTES / least[1]:.1f} GB/s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
