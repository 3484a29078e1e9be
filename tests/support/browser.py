"""A headless Chromium for tests: what a page's script finds in it, and pictures of it."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html import unescape
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
_ANSWER = re.compile(r'<script type="text/plain" id="answer">(.*?)</script>', re.DOTALL)


def browser() -> str:
    """The browser there is; the test is skipped where there is none."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip("no headless Chromium (apt-get install chromium-headless-shell)")
    return found


def _run(page: Path, width: int, height: int, dark: bool, *options: str) -> str:
    profile = page.parent / "profile"
    command = [browser(), "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
    command += ["--disable-dev-shm-usage", f"--user-data-dir={profile}"]
    command += ["--host-resolver-rules=MAP * ~NOTFOUND"]  # a page that asks the network fails
    command += [f"--blink-settings=preferredColorScheme={0 if dark else 1}"]
    command += [f"--window-size={width},{height}", *options, page.resolve().as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=900, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def script(name: str) -> str:
    """A script of tests/browser."""
    return (Path(__file__).parents[1] / "browser" / f"{name}.js").read_text("utf-8")


def ask(page: Path, asked: str, width: int = 1280, dark: bool = False) -> Any:
    """What a script returns in a copy of a page. The page itself holds no script that runs."""
    probe = page.parent / "probe.html"
    body = (
        "const answer = document.createElement('script'); answer.type = 'text/plain';"
        "answer.id = 'answer'; let found; try { found = (() => {" + asked + "})(); }"
        "catch (error) { found = {error: String(error)}; }"
        "answer.textContent = encodeURIComponent(JSON.stringify(found));"
        "document.body.append(answer);"
    )
    text = page.read_text("utf-8").replace("</body>", f"<script>{body}</script></body>")
    probe.write_text(text, encoding="utf-8")
    dom = _run(probe, width, 900, dark, "--dump-dom")
    match = _ANSWER.search(dom)
    assert match is not None, "the browser ran no script"
    found = json.loads(unquote(unescape(match[1])))
    assert not (isinstance(found, dict) and "error" in found), found
    return found


def picture(page: Path, out: Path, width: int, height: int, dark: bool) -> None:
    """A picture of the top of a page, as PNG."""
    _run(page, width, height, dark, f"--screenshot={out}")
