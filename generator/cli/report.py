"""gen report: one page that shows what a sweep found and why, from what is stored."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import InputError

if TYPE_CHECKING:
    from ..report.known import Known, Stored
    from ..targets.host import Host
    from ..targets.target import Target


@dataclass(frozen=True)
class Request:
    """What a report is about. `options`: as the user gave them, to repeat it."""

    target: Target
    host: Host
    scene: str
    model: str
    store: Path | None
    options: str

    @property
    def topic(self) -> tuple[str, str, str]:
        return self.target.name, self.scene, self.model


@click.command()
@click.option(
    "--out",
    default="report.html",
    show_default=True,
    type=click.Path(path_type=Path),
    help="an HTML file",
)
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
def report(out: Path, store: Path | None, measure: bool, seconds: float, **asked: Any) -> None:
    """Lay out a stored sweep and what was measured as one page; its data goes beside as JSON."""
    from ..files import require_place, write_file
    from ..report.page import document_of, json_of, missing_of, render, sections_of

    if out.suffix != ".html":
        raise InputError(f"{out}: expected the name of an HTML file, as report.html")
    data = out.with_suffix(".json")
    require_place(out)
    require_place(data)
    known = _known(_request(store, **asked), out, seconds if measure else None)
    sections = sections_of(known)
    document = document_of(known, sections)
    page = render(sections, document)
    write_file(data, json_of(document) + "\n")
    write_file(out, page)
    for what, reason in missing_of(sections).items():
        if what != "published":
            click.echo(f"not known: {what}: {reason}", err=True)
    size = len(page.encode()) / 1e6
    click.echo(f"written: {out} ({size:.2f} MB), {data}")


def _request(store: Path | None, target: str, scene: str, model: str | None) -> Request:
    from ..impacts.ball_ball.models import find_model
    from ..impacts.ball_ball.scene import find_scene
    from .session import resolve_target

    known = find_model(model or find_scene(scene).model).name
    resolved, host = resolve_target(target)
    given = {"target": target, "scene": scene, "model": model, "store": store}
    plain = {"target": "native", "scene": "any", "model": None, "store": None}
    options = "".join(f" --{key} {value}" for key, value in given.items() if value != plain[key])
    return Request(resolved, host, scene, known, store, options)


def _known(asked: Request, out: Path, seconds: float | None) -> Known:
    """What is stored, and with `seconds` what is measured first. InputError: nothing is known."""
    from ..evidence.records.evidence import read_timings
    from ..places import cache_folder
    from ..report.findings import findings_path, read_findings
    from ..report.known import Known, Stored, read_stored
    from ..sweep.store import default_store
    from .session import RECORDED

    place = asked.store or default_store(cache_folder())
    stored = read_stored(place, *asked.topic) if asked.store or place.exists() else Stored()
    kept = findings_path(cache_folder(), *asked.topic)
    if seconds is not None:
        _measure(asked, stored, kept, seconds)
    findings = read_findings(kept)
    if not stored.trials and findings is None:
        raise InputError(_nothing(asked, place, out))
    commands = [*dict.fromkeys(run.command for run in stored.runs)]
    commands += [findings.command] if findings else []
    return Known(
        *asked.topic,
        cpu=findings.cpu if findings else asked.host.cpu,
        stored=stored,
        findings=findings,
        timings=read_timings(RECORDED, lambda line: click.echo(f"carom: {line}", err=True)),
        commands=(*commands, f"./gen report{asked.options} --out {out.name}"),
        made_at=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def _nothing(asked: Request, place: Path, out: Path) -> str:
    """What was looked for, and the commands that make it: here, or on such a CPU alone."""
    sweep = f"./gen sweep{asked.options}"
    head = f"{place}: nothing stored for {', '.join(asked.topic)}; "
    if asked.host.target.name == asked.target.name:
        return f"{head}run {sweep}, or ./gen report{asked.options} --out {out} --measure"
    own = f"./gen report --measure, which times this CPU ({asked.host.target.name})"
    return f"{head}run {sweep} on a {asked.target.name} and bring its store here, or here {own}"


def _measure(asked: Request, stored: Stored, kept: Path, seconds: float) -> None:
    from ..report.experiments.run import Order, run_experiments
    from ..report.experiments.subjects import calls, lanes_in, subjects
    from ..report.findings import write_findings
    from .session import ROOT, workbench

    target, generated = asked.target, ROOT / "generated"
    if asked.host.target.name != target.name:
        raise InputError(
            f"--measure --target {target.name}: this machine is {asked.host.target.name}, and a "
            "time taken on another CPU is never the target's; expected --target native"
        )
    command = f"./gen report{asked.options} --measure --seconds {seconds:g}"
    order = Order(target, asked.host, asked.scene, asked.model, seconds, command)
    with workbench() as bench:
        found = subjects(
            generated, target, asked.scene, asked.model, bench.compilers, stored.finals
        )
        lanes = lanes_in(generated, target, asked.scene, asked.model)
        called = calls(found, stored.finals, lanes)
        write_findings(kept, run_experiments(bench, found, called, order))
