"""Texts of kernels are those whose hashes are kept, in a sample; tools/golden.py compares all."""

from __future__ import annotations

import subprocess
import sys

from tests.support.kernels import ROOT


def test_a_sample_of_kernels_has_the_text_that_is_kept() -> None:
    """Where a text is meant to change: `tools/golden.py --rewrite`, in the same commit."""
    done = subprocess.run(
        [sys.executable, ROOT / "tools" / "golden.py", "--every", "25"],
        capture_output=True,
        text=True,
        timeout=1800,
        check=False,
    )
    print(done.stdout)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "24 kernels: 0 differ" in done.stdout
