"""gen report: one page that shows what a sweep found and why, from what is stored."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import InputError

if TYPE_CHECKING:
    from ..report.gather import Stored
    from ..targets.host import Host
    from ..targets.target import Target


@dataclass(frozen=True)
class Request:
    """What a report is about. `options`: as the user gave them, to repeat it."""

    resolved: Target
    scene: str
    model: str
    options: str


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="an HTML file")
@click.option("--store", type=click.Path(path_type=Path), help="of a sweep; default: the cache's")
@click.option("--target", default="native", show_default=True)
@click.option("--scene", default="any", show_default=True)
@click.option("--model", help="contact model; default: the scene's")
@click.option("--measure", is_flag=True, help="first measure what no sweep keeps (minutes)")
@click.option(
    "--seconds",
    default=10.0,
    show_default=True,
    type=click.FloatRange(1, 600),
    help="with --measure: for each of its four timings",
)
def report(
    out: Path,
    store: Path | None,
    target: str,
    scene: str,
    model: str | None,
    measure: bool,
    seconds: float,
) -> None:
    """Lay out a stored sweep and what was measured as one page; its data goes beside as JSON."""
    from ..evidence.records.evidence import read_timings
    from ..files import require_place, write_file
    from ..impacts.ball_ball.models import find_model
    from ..impacts.ball_ball.scene import find_scene
    from ..places import cache_folder
    from ..report.cpus import cpu_costs
    from ..report.gather import gather
    from ..report.measured import measured_path, read_measured
    from ..report.page import json_of, render
    from ..sweep.store import default_store
    from .session import RECORDED, resolve_target

    if out.suffix != ".html":
        raise InputError(f"{out}: expected the name of an HTML file, as report.html")
    data = out.with_suffix(".json")
    require_place(out)
    require_place(data)
    known = find_model(model or find_scene(scene).model).name
    resolved, host = resolve_target(target)
    kept = measured_path(cache_folder(), resolved.name, scene, known)
    place = store or default_store(cache_folder())
    stored = _stored(place, store is not None, resolved.name, scene, known)
    options = _options(target, scene, model)
    if measure:
        _measure(Request(resolved, scene, known, options), host, stored, kept, seconds)
    measured = read_measured(kept)
    if not stored.trials and measured is None:
        raise InputError(
            f"{place}: nothing stored for {resolved.name}, {scene}, {known}; "
            f"run ./gen sweep{options}, or ./gen report{options} --out {out} --measure"
        )
    commands = [*dict.fromkeys(run.command for run in stored.runs)]
    commands += [measured.command] if measured else []
    where = f" --store {store}" if store else ""
    commands.append(f"./gen report{options}{where} --out {out.name}")
    timings = read_timings(RECORDED, lambda line: click.echo(f"carom: {line}", err=True))
    costs = cpu_costs(timings, scene, known)
    made = gather(resolved.name, scene, known, host.cpu, stored, measured, commands, costs)
    page = render(made)
    write_file(data, json_of(made) + "\n")
    write_file(out, page)
    for what, reason in made.missing.items():
        if what != "published":
            click.echo(f"not known: {what}: {reason}", err=True)
    size = len(page.encode()) / 1e6
    click.echo(f"written: {out} ({size:.2f} MB), {data}")


def _options(target: str, scene: str, model: str | None) -> str:
    given = [f" --target {target}"] if target != "native" else []
    given += [f" --scene {scene}"] if scene != "any" else []
    given += [f" --model {model}"] if model else []
    return "".join(given)


def _stored(place: Path, named: bool, target: str, scene: str, model: str) -> Stored:
    """What a store holds of a target, scene and model; nothing where there is no default store."""
    from ..report.gather import Stored
    from ..report.subjects import last_finals
    from ..sweep.store import read_only

    if not named and not place.exists():
        return Stored((), (), {})
    with read_only(place) as records:
        trials = tuple(
            t
            for t in records.trials()
            if (t.subject.target, t.subject.scene, t.subject.model) == (target, scene, model)
        )
        used = {t.run for t in trials}
        runs = tuple(r for r in records.runs() if r.id in used)
        return Stored(runs, trials, last_finals(records.finals(), target, scene, model))


def _measure(request: Request, host: Host, stored: Stored, kept: Path, seconds: float) -> None:
    from ..report.measure import measure
    from ..report.measured import write_measured
    from ..report.subjects import calls, lanes_in, subjects
    from .session import ROOT, workbench

    target = request.resolved
    if host.target.name != target.name:
        raise InputError(
            f"--measure --target {target.name}: this machine is {host.target.name}, and a time "
            "taken on another CPU is never the target's; expected --target native"
        )
    command = f"./gen report{request.options} --measure --seconds {seconds:g}"
    with workbench() as bench:
        found = subjects(
            ROOT / "generated",
            target,
            request.scene,
            request.model,
            bench.compilers,
            stored.finals,
        )
        lanes = lanes_in(ROOT / "generated", target, request.scene, request.model)
        called = calls(found, stored.finals, lanes)
        made = measure(
            bench, found, called, target, host, request.scene, request.model, seconds, command
        )
    write_measured(kept, made)
