"""Under which rules a verdict was given."""

from __future__ import annotations

from pathlib import Path

import pytest

from generator.choice.verifier import verification_hash
from generator.impacts.registry import IMPACTS


@pytest.mark.parametrize("impact", [each.name for each in IMPACTS])
def test_a_verdict_holds_only_under_its_impacts_own_rules(
    monkeypatch: pytest.MonkeyPatch, impact: str
) -> None:
    """Where the evidence of an impact changes, another verdict is wanted."""
    folder = impact.replace("-", "_")
    before = verification_hash.__wrapped__(folder)
    read = Path.read_text

    def changed(path: Path, *asked: str) -> str:
        return read(path, *asked) + ("# other" if f"impacts/{folder}/" in path.as_posix() else "")

    monkeypatch.setattr(Path, "read_text", changed)
    print(f"{impact}: {before}")
    assert verification_hash.__wrapped__(folder) != before
