"""python -m generator: the gen command."""

from __future__ import annotations

import sys

_CURE = "pip install 'carom[gen]', or pip install '.[gen]' in a clone"


def main() -> None:
    """Run it; where its packages are not installed, say in one line how they are; status 2."""
    try:
        from .cli.main import main as gen
    except ModuleNotFoundError as error:
        sys.exit(_without(error))
    gen()


def _without(error: ModuleNotFoundError) -> int:
    print(f"gen: the generator needs packages that are not here: {error}; {_CURE}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    main()
