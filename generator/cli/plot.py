"""gen plot: the pictures of the documentation, measured or computed here."""

from __future__ import annotations

import json
from pathlib import Path

import click

from ..errors import InputError


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="an SVG file")
@click.option("--models", is_flag=True, help="how far the contact models differ, instead of times")
@click.option("--from", "source", type=click.Path(path_type=Path), help="draw this JSON again")
@click.option("--target", default="native", show_default=True)
@click.option("--scene", default="any", show_default=True)
@click.option("--model", help="contact model; default: the scene's")
@click.option(
    "--seconds", default=60.0, show_default=True, type=click.FloatRange(1, 3600), help="for timing"
)
def plot(
    out: Path,
    models: bool,
    source: Path | None,
    target: str,
    scene: str,
    model: str | None,
    seconds: float,
) -> None:
    """Draw time against error of fixed steps and exact steppers; its data goes beside as JSON."""
    from ..files import require_place

    if out.suffix != ".svg":
        raise InputError(f"{out}: expected the name of an SVG file, as plot.svg")
    require_place(out)
    if models:
        _models(out)
    elif source is not None:
        _redraw(out, source)
    else:
        _measure(out, target, scene, model, seconds)


def _models(out: Path) -> None:
    from ..evidence.timing.bench_tool import build_bench_tool
    from ..files import write_file
    from ..places import cache_folder
    from ..report.figures.model_gap import draw, model_gaps

    gaps = model_gaps(build_bench_tool(cache_folder()))
    write_file(out, draw(gaps))
    for (model, spin), gap in gaps.items():
        click.echo(
            f"{model}, {spin}: velocities up to {gap.speed.max():.2f} % apart, the object ball's "
            f"direction up to {abs(gap.direction).max():.3f} degrees"
        )
    click.echo(f"written: {out}")


def _redraw(out: Path, source: Path) -> None:
    from ..files import write_file
    from ..report.figures.speed_error import speed_error_of
    from ..report.figures.speed_error_svg import draw

    try:
        measured = speed_error_of(json.loads(source.read_text("utf-8")))
    except OSError as error:
        raise InputError(f"{source}: cannot be read: {error.strerror}") from None
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{source}: not what gen plot wrote: {error}") from None
    write_file(out, draw(measured))
    click.echo(f"written: {out}")


def _measure(out: Path, target: str, scene: str, model: str | None, seconds: float) -> None:
    from ..choice.lookup import require_runs
    from ..files import require_place, write_file
    from ..impacts.ball_ball.models import find_model
    from ..impacts.ball_ball.scene import find_scene
    from ..report.figures.speed_error import measure_speed_error
    from ..report.figures.speed_error_svg import draw
    from .session import ROOT, resolve_target, workbench

    data = out.with_suffix(".json")
    require_place(data)
    known = find_model(model or find_scene(scene).model).name
    if find_scene(scene).fixed:
        raise InputError(f"--scene {scene}: fixes parameters; expected any, which the plot times")
    resolved, host = resolve_target(target)
    require_runs(host, resolved)
    with workbench() as bench:
        measured = measure_speed_error(
            bench, ROOT / "generated", resolved, host, scene, known, seconds
        )
    write_file(data, json.dumps(measured.document(), indent=1) + "\n")
    write_file(out, draw(measured))
    for p in measured.points:
        goal = f"N = {p.steps}" if p.steps else f"E = {p.budget:g}"
        over = "" if p.within_budget else "  over its budget"
        click.echo(
            f"{p.group:9}{p.stepper:6} {goal:12} {p.ns:12.1f} ns {p.ratio:10.5f} of paper-initial "
            f" error {p.max_rel_error:.1e}{over}"
        )
    click.echo(f"written: {out}, {data}")
