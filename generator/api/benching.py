"""The kernels of `generated/` verified and timed on this machine."""

from __future__ import annotations

import platform
from dataclasses import dataclass
from typing import Any

from ..choice.lookup import require_runs
from ..choice.selection import how_to_make, place_of, read_selection
from ..errors import InputError
from ..registry.question import DEFAULT_IMPACT, find_impact
from .bench_rows import BenchRow, bench_rows
from .closed_forms import ClosedRow
from .session import Session, resolve_target


@dataclass(frozen=True)
class Benched:
    """The machine, and a row for each kernel and set of cases, `paper-initial` among them."""

    host: dict[str, Any]
    rows: tuple[BenchRow, ...]
    closed_forms: tuple[ClosedRow, ...] = ()  # what leaves friction on the table away

    @property
    def failed(self) -> tuple[BenchRow, ...]:
        return tuple(row for row in self.rows if row.rejected)

    def document(self) -> dict[str, Any]:
        """What `gen bench --json` writes."""
        return {
            "schema": 1,
            "host": self.host,
            "kernels": [row.document() for row in self.rows],
            "closed_forms": [row.document() for row in self.closed_forms],
        }


def bench(
    target: str = "native",
    scene: str = "any",
    model: str | None = None,
    seconds: float = 20.0,
    session: Session | None = None,
    impact: str = DEFAULT_IMPACT,
) -> Benched:
    """Verify and time the kernels of a folder of generated/ and `paper-initial`.

    `model`: only this contact model; None: all that were generated. `seconds`: for timing each
    model. Raises InputError where nothing was generated, KernelError where the target's code cannot
    run here.
    """
    session = session or Session()
    collides = find_impact(impact)
    collides.find_scene(scene)
    if model is not None:
        collides.find_model(model)
    resolved, host = resolve_target(target)
    require_runs(host, resolved)
    folder = place_of(session.generated, target, scene, impact)
    selection = read_selection(folder)
    if selection is None:
        raise InputError(f"{folder}: nothing generated; run {how_to_make(folder)}")
    entries = [e for e in selection.kernels if model in (None, e.model)]
    if not entries:
        raise InputError(
            f"{folder}: no kernel for --model {model}; run {how_to_make(folder)} --model {model}"
        )
    with session.workbench(impact=collides) as tools:
        rows = bench_rows(tools, resolved, scene, entries, seconds)
        machine = {
            "cpu": host.cpu,
            "target": host.target.name,
            "system": platform.system(),
            "machine": platform.machine(),
            "compilers": {c.code: c.version for c in tools.compilers.values()},
        }
    return Benched(machine, rows.kernels, rows.closed_forms)
