"""Calls carom_count of a library: a process of its own, which a crash takes alone."""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path


def main(library: str, rows: str, out: str) -> int:
    """Rows of 24 doubles from the file `rows`, counts as JSON to the file `out`."""
    raw = Path(rows).read_bytes()
    buffer = (ctypes.c_double * (len(raw) // 8)).from_buffer_copy(raw)
    count = ctypes.CDLL(library).carom_count
    count.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_char_p]
    return count(buffer, len(buffer) // 24, out.encode())


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
