"""The kernels in WebAssembly, built and then run under Node against the reference."""

from __future__ import annotations

import re
import shutil
import sys

import pytest

from tests.support.installed import ROOT, run

TOOLS = {"wasm-ld": "lld-19", "node": "nodejs", "cmake": "cmake", "ninja": "ninja-build"}


def missing() -> list[str]:
    """Debian packages of what is not here."""
    lacking = [package for tool, package in TOOLS.items() if shutil.which(tool) is None]
    if "lld-19" in lacking and shutil.which("wasm-ld-19"):
        lacking.remove("lld-19")
    if not (shutil.which("clang++-19") or shutil.which("clang++")):
        lacking.append("clang-19")
    return lacking


@pytest.mark.skipif(bool(missing()), reason=f"not here: {', '.join(missing())}")
def test_javascript_gets_what_the_reference_says() -> None:
    build = ROOT / "build" / "wasm"
    python = f"-DPython_EXECUTABLE={sys.executable}"
    run(["cmake", "-S", ROOT, "--preset", "wasm", python])
    run(["cmake", "--build", build])
    text = run(["node", "--test", ROOT / "js" / "carom.test.mjs"])
    print("\n".join(re.findall(r"largest error.*|wasm32\..*", text)))
    assert "# fail 0" in text or "fail 0" in text
    assert int(re.search(r"pass (\d+)", text)[1]) >= 15
    size = (build / "js" / "carom.wasm").stat().st_size
    print(f"carom.wasm: {size} bytes")
    # pooltool's kernels have a second stepper, for errors that its table made grow; the cushion's
    # one, by power series, is 87 kB.
    assert size < 1_250_000
