"""A function of a library run on cases in another process, its answer as JSON."""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import KernelError
from ...toolchain.process import run
from ..verification.errors import Array

_BESIDE_PACKAGE = Path(__file__).parents[3]  # where python -m finds the package


def call_isolated(
    function: str, library: Path, cases: Array, timeout: float, *more: object
) -> dict[str, Any]:
    """What `function` wrote for rows of numbers. Raises KernelError where it failed."""
    with tempfile.TemporaryDirectory() as name:
        rows, out = Path(name, "rows"), Path(name, "out")
        np.ascontiguousarray(cases, dtype=np.float64).tofile(rows)
        command = [sys.executable, "-m", f"{__package__}.run_library", function]
        words = map(str, (library.resolve(), rows, cases.shape[1], out, *more))
        done = run([*command, *words], timeout, cwd=_BESIDE_PACKAGE)
        if done.code != 0:
            raise KernelError(f"{function}: {done.first_error}")
        document: dict[str, Any] = json.loads(out.read_text("utf-8"))
        return document
