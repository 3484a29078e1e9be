"""gen bench: time and check the emitted kernels on this machine, as JSON."""

from __future__ import annotations

import json
import platform
from pathlib import Path

import click

from ..errors import InputError


@click.command()
@click.option("--target", default="native", show_default=True)
@click.option("--scene", default="any", show_default=True)
@click.option("--model", help="only this contact model; default: all that were generated")
@click.option("--json", "json_path", required=True, type=click.Path(path_type=Path))
@click.option("--seconds", default=20.0, show_default=True, help="time for timing, each model")
def bench(target: str, scene: str, model: str | None, json_path: Path, seconds: float) -> int:
    """Verify and time the kernels of generated/<target>/<scene>/ and paper-initial."""
    from ..choice.lookup import require_runs
    from ..choice.selection import read_selection
    from ..files import is_stdout, require_place, write_file
    from ..impacts.ball_ball.models import find_model
    from ..impacts.ball_ball.scene import find_scene
    from .bench_rows import bench_rows
    from .session import ROOT, resolve_target, workbench

    find_scene(scene)
    if model is not None:
        find_model(model)
    resolved, host = resolve_target(target)
    require_runs(host, resolved)
    folder = ROOT / "generated" / target / scene
    selection = read_selection(folder)
    if selection is None:
        raise InputError(
            f"{folder}: nothing generated; run ./gen --target {target} --scene {scene}"
        )
    entries = [e for e in selection.kernels if model in (None, e.model)]
    if not entries:
        raise InputError(f"{folder}: no kernel for --model {model}; run ./gen with that --model")
    require_place(json_path)
    with workbench() as tools:
        rows = bench_rows(tools, resolved, scene, entries, seconds)
        document = {
            "schema": 1,
            "host": {
                "cpu": host.cpu,
                "target": host.target.name,
                "system": platform.system(),
                "machine": platform.machine(),
                "compilers": {c.code: c.version for c in tools.compilers.values()},
            },
            "kernels": [row.document() for row in rows],
        }
    write_file(json_path, json.dumps(document, indent=2) + "\n")
    apart = is_stdout(json_path)
    for row in rows:
        click.echo(row.line(), err=apart)
        if line := row.threads_line():
            click.echo(line, err=apart)
    failed = [row for row in rows if row.rejected]
    click.echo(f"{len(rows)} kernels, {len(failed)} failed; written: {json_path}", err=apart)
    return 1 if failed else 0
