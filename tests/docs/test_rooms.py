"""README, CONTRIBUTING and the page on design show one table of rooms, the one there is."""

from __future__ import annotations

import re

from tests.support.kernels import ROOT

BELOW = {"errors", "files", "places"}  # modules that every room may use


def _table(page: str) -> list[str]:
    text = (ROOT / page).read_text("utf-8").replace("(docs/", "(")
    start = text.index("| room of `generator/` |")
    return text[start : text.index("\n\n", start)].splitlines()


def test_three_pages_show_one_table_of_the_rooms_that_there_are() -> None:
    tables = [_table(page) for page in ("README.md", "CONTRIBUTING.md", "docs/design.md")]
    assert tables[0] == tables[1] == tables[2]
    named = {found[1] for row in tables[0][2:] if (found := re.match(r"\| `(\w+)` \|", row))}
    there = {p.parent.name for p in (ROOT / "generator").glob("*/__init__.py")}
    print(f"{len(named)} rooms in the table, {len(there)} in generator/")
    assert named == there
