"""docs/api.md from the signatures and docstrings of generator/api: `python tools/api_page.py`."""

from __future__ import annotations

import inspect
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from generator import api  # noqa: E402

PAGE = ROOT / "docs" / "api.md"
HEAD = """# The Python API

Written by `.venv/bin/python tools/api_page.py` from the docstrings of `generator/api/`; a test
compares. In an installed wheel the package is `carom_gen`. Every function takes names and numbers,
or a frozen request with them, and last a `Session`: where `generated/` lies, and a `Listener` that
is told of progress. `InputError` and `KernelError` of `carom_gen.errors` say in one line what
cannot be, and what failed. The command line only parses, calls these functions and prints.

    from carom_gen import api
    cases = api.read_cases(Path("cases.csv"))
    found = api.collide(cases.rows, api.Request(model="pooltool", max_error=1e-6))
    print(found.kernel, found.collided, found.outcomes[0])
    print(api.emit(found.kernel))
"""


def page() -> str:
    """The text of docs/api.md: functions first, then what they take and give."""
    found = {name: getattr(api, name) for name in dir(api)}
    functions = {name: each for name, each in found.items() if not inspect.isclass(each)}
    types = {name: each for name, each in found.items() if inspect.isclass(each)}
    parts = [HEAD, "## Functions\n", *map(_entry, functions, functions.values())]
    return "\n".join([*parts, "## Types\n", *map(_entry, types, types.values())])


def _entry(name: str, each: object) -> str:
    text = inspect.cleandoc(each.__doc__ or "")
    return f"### {name}\n\n    {name}{_signature(each)}\n\n{text}\n"


def _signature(each: object) -> str:
    """Names, types and defaults; a default that is made anew is `...`."""
    signature = inspect.signature(each)  # type: ignore[arg-type]
    plain = str(signature).replace("'", "").replace("<factory>", "...")
    plain = re.sub(r"<function <lambda> at 0x[0-9a-f]+>", "...", plain)
    return re.sub(r"PosixPath\((.*?)\)", r"\1", plain)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
