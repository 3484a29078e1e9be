"""What a worker of a test's cluster says it is: the CPU that its environment names."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from generator.sweep.worker import Identity, identify


def told() -> Identity:
    """CAROM_TEST_CPU; each time it is asked is a line of the file CAROM_TEST_LOG."""
    with Path(os.environ["CAROM_TEST_LOG"]).open("a", encoding="utf-8") as file:
        file.write("asked\n")
    return replace(identify(), target=os.environ["CAROM_TEST_CPU"], exact=True)
