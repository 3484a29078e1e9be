"""clang-format (pinned from PyPI) over generated C and C++."""

from __future__ import annotations

import subprocess
import sys
from functools import lru_cache
from pathlib import Path

from ..errors import KernelError

STYLE = "{BasedOnStyle: Google, ColumnLimit: 100, SortIncludes: Never, ReflowComments: false}"


@lru_cache(maxsize=64)  # a folder's kernels share one header
def format_source(text: str, filename: str) -> str:
    """The text as clang-format lays it out, blank lines at most one."""
    tool = Path(sys.executable).with_name("clang-format")
    command = [str(tool) if tool.exists() else "clang-format", f"--style={STYLE}"]
    command.append(f"--assume-filename={filename}")
    try:
        done = subprocess.run(command, input=text, capture_output=True, text=True)
    except OSError as error:
        raise KernelError(
            f"clang-format cannot run ({error}); run ./gen once to install it"
        ) from None
    if done.returncode != 0:
        raise KernelError(f"clang-format failed on {filename}: {done.stderr.strip()[:200]}")
    return done.stdout
