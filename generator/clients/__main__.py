"""python -m generator.clients FOLDER: the kernels of the Python module, for its build."""

from __future__ import annotations

import sys
from pathlib import Path

from generator.clients.kernel_set import write_kernel_set
from generator.errors import InputError, KernelError


def main(arguments: list[str]) -> int:
    """Write the kernel set into the folder that is the one argument; the exit status."""
    if len(arguments) != 1:
        print("usage: python -m generator.clients FOLDER", file=sys.stderr)
        return 2
    try:
        changed = write_kernel_set(Path(arguments[0]))
    except (InputError, KernelError) as error:
        print(f"generator.clients: {error}", file=sys.stderr)
        return 2 if isinstance(error, InputError) else 1
    print(f"{arguments[0]}: {changed} files changed")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
