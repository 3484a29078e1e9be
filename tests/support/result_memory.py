"""Memory that results of batches hold, in a process of its own: python result_memory.py SITE."""

from __future__ import annotations

import sys
import threading
from pathlib import Path

sys.path.insert(0, sys.argv[1])

import numpy as np

import carom

PAGE = 4096
MANY, FEW = 1_000_000, 10  # results of 97 MB and of 970 bytes
PARAMETERS = carom.Parameters()


def held() -> int:
    """Bytes of this process that are in memory."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE


def balls(count: int) -> np.ndarray:
    cue = [[0, 0, 0.028575], [0, 1.5, 0], [0, 0, 0]]
    ball = [[0.02, 0.0535, 0.028575], [0, 0, 0], [0, 0, 0]]
    one = carom.columns(np.array([cue]), np.array([ball]))
    return np.broadcast_to(one, (18, count))


def told(what: str, before: int) -> None:
    print(f"{what}: {(held() - before) / 1e6:.1f} MB", flush=True)


def small_after_large(count: int) -> tuple:
    """A small result, made by a kernel that is gone and that had made a large one."""
    kernel = carom.Kernel(max_error=1e-3)
    kernel.collide_batch(PARAMETERS, balls(count))
    return kernel.collide_batch(PARAMETERS, balls(FEW))


def statuses(kernel: carom.Kernel) -> np.ndarray:
    return kernel.collide_batch(PARAMETERS, balls(MANY))[1]


def main() -> None:
    small_after_large(1000)
    before = held()
    kept = [small_after_large(MANY)]
    told("970 bytes after 97 MB, kernel gone", before)
    thread = threading.Thread(target=lambda: kept.append(small_after_large(MANY)))
    thread.start()
    thread.join()
    told("the same in a thread", before)
    kept.append(statuses(carom.Kernel(max_error=1e-3)))
    told("1 MB of statuses without their columns, kernel gone", before)
    kernel = carom.Kernel(max_error=1e-3)
    kernel.collide_batch(PARAMETERS, balls(MANY))
    kept.append(kernel.collide_batch(PARAMETERS, balls(MANY * 6 // 10)))
    del kernel
    told("58 MB after 97 MB, kernel gone", before)
    kept.pop()
    told("and dropped", before)
    kernel = carom.Kernel(max_error=1e-3)
    kernel.collide_batch(PARAMETERS, balls(MANY))
    kernel.collide_batch(PARAMETERS, balls(FEW))
    told("a kernel whose last result was of 970 bytes", before)
    assert len(kept) == 3 and kept[0][0].shape == (12, FEW)


main()
