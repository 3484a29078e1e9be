"""python/carom/_carom.pyi from the built module, by nanobind: python tools/stubs.py SITE.

SITE is a folder with the module carom in it, as pip installs it.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
STUB = ROOT / "python" / "carom" / "_carom.pyi"
HEAD = "# Made by nanobind: python tools/stubs.py. Signatures and texts are in _carom.cpp.\n"


def stub_of(site: Path) -> str:
    """The text of the stub of a module that lies in `site`."""
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "_carom.pyi"
        command = [sys.executable, "-m", "nanobind.stubgen", "-q", "-m", "carom._carom"]
        options = ("-i", str(site), "-o", str(made))
        subprocess.run([*command, *options], check=True, cwd=folder)
        return HEAD + made.read_text("utf-8")


if __name__ == "__main__":
    STUB.write_text(stub_of(Path(sys.argv[1])), encoding="utf-8")
