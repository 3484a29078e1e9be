"""python -m generator.clients FOLDER: the kernels of the Python or JavaScript module."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..errors import InputError, KernelError
from ..registry.question import Goal, read_goal
from .kernel_set import BY_ARCHITECTURE, GOALS, Choice, write_kernel_set


def _names(text: str) -> tuple[str, ...]:
    return tuple(name for name in text.split(",") if name)


def _goals(text: str) -> tuple[Goal, ...]:
    try:
        goals = [read_goal(name) for name in _names(text)]
    except ValueError as error:
        raise InputError(f"--goals: {error}") from None
    return tuple(sorted(goals, key=lambda goal: -(goal.budget or 1.0)))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m generator.clients")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--architecture", choices=BY_ARCHITECTURE, default="x86_64")
    parser.add_argument("--targets", default="", help="of the architecture, best first: all")
    parser.add_argument("--models", default=",".join(Choice().models))
    parser.add_argument("--goals", default=",".join(map(str, GOALS)), help="n1000: fixed steps")
    return parser


def main(arguments: list[str]) -> int:
    """Write the kernel set into the folder that the first argument names; the exit status."""
    asked = _parser().parse_args(arguments)
    targets = _names(asked.targets) or BY_ARCHITECTURE[asked.architecture]
    try:
        choice = Choice(targets, _names(asked.models), _goals(asked.goals))
        changed = write_kernel_set(asked.folder, choice)
    except (InputError, KernelError) as error:
        print(f"generator.clients: {error}", file=sys.stderr)
        return 2 if isinstance(error, InputError) else 1
    print(f"{asked.folder}: {changed} files changed")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
