"""python -m generator.clients FOLDER [wasm]: the kernels of the Python or JavaScript module."""

from __future__ import annotations

import sys
from pathlib import Path

from ..errors import InputError, KernelError
from .kernel_set import TARGETS, WASM_TARGETS, write_kernel_set


def main(arguments: list[str]) -> int:
    """Write the kernel set into the folder that the first argument names; the exit status."""
    if len(arguments) not in (1, 2) or arguments[1:] not in ([], ["wasm"]):
        print("usage: python -m generator.clients FOLDER [wasm]", file=sys.stderr)
        return 2
    try:
        targets = WASM_TARGETS if arguments[1:] else TARGETS
        changed = write_kernel_set(Path(arguments[0]), targets)
    except (InputError, KernelError) as error:
        print(f"generator.clients: {error}", file=sys.stderr)
        return 2 if isinstance(error, InputError) else 1
    print(f"{arguments[0]}: {changed} files changed")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
