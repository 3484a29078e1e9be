"""Calls one function of a library in a process of its own, which a crash takes alone.

python -m generator.evidence.profiling.run_library carom_count LIBRARY ROWS WIDTH OUT
python -m generator.evidence.profiling.run_library carom_sample LIBRARY ROWS WIDTH OUT KERNEL SECS
"""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path


def main(function: str, library: str, rows: str, width: str, out: str, *more: str) -> int:
    """ROWS: a file of float64 in rows of so many; OUT: the JSON file that the function writes."""
    raw = Path(rows).read_bytes()
    buffer = (ctypes.c_double * (len(raw) // 8)).from_buffer_copy(raw)
    count, file = ctypes.c_size_t(len(buffer) // int(width)), out.encode()
    loaded = ctypes.CDLL(library)
    if function == "carom_count":
        return int(loaded.carom_count(buffer, count, file))
    kernel, seconds = more
    limit = ctypes.c_double(float(seconds))
    return int(loaded.carom_sample(kernel.encode(), buffer, count, limit, file))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
