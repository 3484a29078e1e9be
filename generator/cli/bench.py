"""gen bench: time and check the emitted kernels on this machine."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .. import api
from ..files import is_stdout, require_place, write_file
from . import options
from .show import session, show, three_digits

if TYPE_CHECKING:
    from ..api.bench_rows import BenchRow
    from ..evidence.timing.ratios import TimingResult


@click.command()
@options.IMPACT
@options.TARGET
@options.SCENE
@click.option("--model", help="only this contact model; default: all that were generated")
@click.option("--json", "json_path", type=options.PLACE, help="write all figures to a file")
@options.seconds(20.0, "each model")
def bench(json_path: Path | None, **asked: Any) -> int:
    """Verify and time the kernels that were generated and paper-initial."""
    if json_path is not None:
        require_place(json_path)
    with session() as told:
        found = api.bench(**asked, session=told)
    apart = json_path is not None and is_stdout(json_path)
    if json_path is not None:
        write_file(json_path, json.dumps(found.document(), indent=2) + "\n")
    for fixed, against in ((True, "the same scheme"), (False, "the exact solution")):
        rows = [r for r in found.rows if not r.rejected and (r.steps is not None) is fixed]
        title = f"{'fixed steps' if fixed else 'exact kernels'}: largest error against {against}"
        if rows:
            impact = rows[0].candidate.variant.question.row
            title, first = f"{title}, over {impact.relative_symbol}", rows[0].baseline_name
            show({title: [_row(row, first) for row in rows]}, False, apart)
    if found.closed_forms:
        first = found.rows[0].baseline_name
        title = "closed forms without friction on the table: another question, in batches"
        forms = [
            _figures(f.timing, first) | {"cases": f.cases, "closed form": f.name}
            for f in found.closed_forms
        ]
        show({title: forms}, False, apart)
    for row in found.failed:
        click.echo(f"FAILED {row.candidate.name}: {row.rejected}", err=apart)
    for row in found.rows:
        if row.threads:
            click.echo(f"{row.candidate.name}: {_threads(row.threads)}", err=apart)
    written = f"; written: {json_path}" if json_path is not None else ""
    names = {row.candidate.name for row in found.rows}
    click.echo(f"{len(names)} kernels, {len(found.failed)} failed{written}", err=apart)
    return 1 if found.failed else 0


def _figures(timing: TimingResult | None, baseline: str) -> dict[str, object]:
    low, high = timing.ratio_ci if timing else (0.0, 0.0)
    return {
        "ns": f"{timing.ns:.1f}" if timing else None,
        f"of {baseline}": three_digits(timing.ratio) if timing else None,
        "95 %": f"{three_digits(low)}-{three_digits(high)}" if timing else None,
    }


def _row(row: BenchRow, baseline: str) -> dict[str, object]:
    return {
        **_figures(row.timing, baseline),
        "cases": row.cases,
        "error": None if row.error is None else f"{row.error:.1e}",
        "of loops' bound": f"{row.of_bound:.2f}" if row.of_bound else None,
        "kernel": row.candidate.name,
    }


def _threads(threads: dict[int, float]) -> str:
    shown = (f"{n}: {ns:.1f} ns ({threads[1] / ns:.2f})" for n, ns in threads.items())
    return f"threads (times as fast as one) {', '.join(shown)}"
