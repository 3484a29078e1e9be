"""The pages that people read: links, lengths, what is made of sources, and no figure twice."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.browser import ask
from tests.support.kernels import ROOT
from tools import reference_page

OTHERS = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "examples/README.md")
PAGES = sorted([*(ROOT / "docs").glob("*.md"), *(ROOT / name for name in OTHERS)])
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


def _without_code(text: str) -> str:
    return re.sub(r"```.*?```|`[^`\n]*`", "", text, flags=re.DOTALL)


def _anchors(page: Path) -> set[str]:
    """As GitHub and MkDocs name headings."""
    titles = re.findall(r"^#+ (.+)$", page.read_text("utf-8"), re.MULTILINE)
    plain = [re.sub(r"[^\w\- ]", "", title.replace("`", "").lower()) for title in titles]
    return {title.strip().replace(" ", "-") for title in plain}


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_no_link_is_broken(page: Path) -> None:
    for link in LINK.findall(_without_code(page.read_text("utf-8"))):
        if link.startswith(("http://", "https://", "mailto:")):
            continue
        name, _, anchor = link.partition("#")
        there = (page.parent / name).resolve() if name else page
        assert there.exists(), f"{page.name}: {link}"
        if anchor and there.suffix == ".md":
            assert anchor in _anchors(there), f"{page.name}: {link}"


def test_the_readme_is_short_and_shows_the_summary_of_the_measurements() -> None:
    readme, measured = (
        (ROOT / name).read_text("utf-8") for name in ("README.md", "docs/measurements.md")
    )
    assert len(readme.splitlines()) <= 150
    tables = [
        re.search(r"<!-- summary.*?-->\n(.*?)\n<!-- end of summary -->", text, re.DOTALL)
        for text in (readme, measured)
    ]
    assert tables[0] is not None and tables[1] is not None
    assert tables[0][1] == tables[1][1]
    rest = readme.replace(tables[0][1], "")
    assert not re.findall(r"\d(?:\.\d+)? (?:ns|us|ms|MB|%)(?!\w)", rest), "figures of their own"


FIGURE = re.compile(r"\b\d\.\d+e-?\d+\b|\b\d+(?:\.\d+)? (?:ns|us|MB)(?!\w)|\b\d+,(?!000)\d{3}\b")


def test_no_measured_figure_stands_on_two_pages() -> None:
    """Times, sizes, errors and counts; the README's summary is that of the measurements."""
    found: dict[str, set[str]] = {}
    for page in (ROOT / "docs").glob("*.md"):
        for figure in FIGURE.findall(_without_code(page.read_text("utf-8"))):
            found.setdefault(figure, set()).add(page.name)
    print(f"{len(found)} figures")
    twice = {figure: sorted(pages) for figure, pages in found.items() if len(pages) > 1}
    assert not twice


def test_the_reference_is_made_of_the_sources() -> None:
    """The header, the typed header, the stub and the types of JavaScript."""
    made = reference_page.page()
    assert made == reference_page.PAGE.read_text("utf-8"), "python tools/reference_page.py"


def test_each_page_is_in_the_site_and_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "-q", "-d", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    print(done.stdout + done.stderr)
    assert done.returncode == 0 and "WARNING" not in done.stderr
    assert {page.stem for page in tmp_path.glob("*.html")} >= {
        page.stem for page in (ROOT / "docs").glob("*.md")
    }


def test_no_page_is_wider_than_a_narrow_screen(tmp_path: Path) -> None:
    """Tables, pictures and code scroll by themselves; the pages here have the widest."""
    command = [sys.executable, "-m", "mkdocs", "build", "-q", "-d", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True)
    for name in ("measurements", "sweep", "quick-start"):
        wide = ask(tmp_path / f"{name}.html", "return document.documentElement.scrollWidth", 500)
        print(f"{name}: {wide} of 500 pixels")
        assert wide <= 500


SNIPPETS = re.findall(
    r"```python\n(.*?)```", (ROOT / "docs" / "tutorial.md").read_text("utf-8"), re.DOTALL
)


def test_the_tutorial_runs_from_top_to_bottom() -> None:
    from tests.support.installed import run, site

    told = run([sys.executable, "-P", "-c", "\n".join(SNIPPETS)], PYTHONPATH=str(site()))
    print(told)
    lines = told.splitlines()
    assert lines[0] == "OK" and lines[-1].startswith("most throw:")
    away = [float(line.split()[-2]) for line in lines[-5:-1]]  # two of fixed steps, two budgets
    assert away[0] > 50 * away[1] and away[2] < 1e-3 * 2 and away[3] < 1e-6 * 2  # of 2 m/s
