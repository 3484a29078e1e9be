"""Figures of earlier runs, kept under the hash of everything that they depend on."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np

from ..evidence.verification.errors import Array
from ..files import write_file


@dataclass
class Store:
    """A folder of JSON documents by kind and key. `fresh`: everything is made anew, and kept."""

    folder: Path
    fresh: bool = False
    _lock: Lock = field(default_factory=Lock)
    made: dict[str, int] = field(default_factory=dict)
    reused: dict[str, int] = field(default_factory=dict)

    def kept(self, kind: str, key: str, make: Callable[[], Any]) -> Any:
        """The document that was kept, or the one made now. What does not read back is made anew."""
        path = self.folder / kind / f"{key}.json"
        if not self.fresh:
            try:
                document = json.loads(path.read_text("utf-8"))
            except (OSError, ValueError):
                pass
            else:
                self.count(kind, True)
                return document
        document = make()
        write_file(path, json.dumps(document), parents=True)
        self.count(kind, False)
        return document

    def count(self, kind: str, reused: bool) -> None:
        counts = self.reused if reused else self.made
        with self._lock:
            counts[kind] = counts.get(kind, 0) + 1

    def kept_array(self, kind: str, key: str, columns: int, make: Callable[[], Array]) -> Array:
        """As `kept`, for a table of numbers; NaN and infinity are kept too."""
        rows = self.kept(kind, key, lambda: make().tolist())
        return np.array(rows, dtype=np.float64).reshape(-1, columns)

    def counts(self) -> str:
        """Text such as `36 of 36 verdicts`: what was reused, by kind; empty where nothing was."""
        texts = []
        for kind, count in sorted(self.reused.items()):
            whole = count + self.made.get(kind, 0)
            texts.append(f"{count} of {whole} {kind}")
        return ", ".join(texts)
