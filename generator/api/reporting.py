"""One page that shows what a sweep found and why, from what is stored; and single pictures."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from ..choice.lookup import require_runs
from ..errors import InputError
from ..evidence.timing.bench_tool import build_bench_tool
from ..registry.question import DEFAULT_IMPACT, find_impact
from ..report.experiments.run import Order, run_experiments
from ..report.experiments.subjects import calls, lanes_in, subjects
from ..report.figures import speed_error_svg
from ..report.figures.models import Drawn, models_picture
from ..report.figures.scene_costs import PLAIN, SceneCost
from ..report.figures.scene_costs import scene_costs as costs_of
from ..report.figures.speed_error import SpeedError, measure_speed_error, speed_error_of
from ..report.findings import Findings, findings_path, read_findings, write_findings
from ..report.known import Known, Stored, read_stored
from ..report.page import json_of, render
from ..report.report import make_report
from ..sweep.store import default_store
from ..targets.host import Host
from ..targets.target import Target
from .session import Session, resolve_target


@dataclass(frozen=True)
class ReportRequest:
    """What a report is about.

    `store`: of a sweep; None: that in the cache. `seconds`: first measure what no sweep keeps, for
    so long in each of four timings; None: show what was measured before. `out`: where the page will
    lie, for the command on it that makes it again. InputError: of another impact there is no page.
    """

    target: str = "native"
    scene: str = "any"
    model: str | None = None
    store: Path | None = None
    seconds: float | None = None
    out: Path = Path("report.html")
    impact: str = DEFAULT_IMPACT

    def __post_init__(self) -> None:
        if find_impact(self.impact).name != DEFAULT_IMPACT:
            raise InputError(
                f"--impact {self.impact}: the page is of {DEFAULT_IMPACT} alone; "
                f"./gen sweep --impact {self.impact} tells what it found, "
                f"./gen bench --impact {self.impact} --json OUT what was timed"
            )

    @property
    def options(self) -> str:
        """Those that are not the default, as on a command line."""
        given = {"target": self.target, "scene": self.scene, "model": self.model}
        usual = {"target": "native", "scene": "any", "model": None, "store": None}
        named = {**given, "store": self.store}.items()
        return "".join(f" --{key} {value}" for key, value in named if value != usual[key])


@dataclass(frozen=True)
class Reported:
    """A page in HTML, its data in JSON, and why each section that lacks figures does."""

    page: str
    data: str
    missing: Mapping[str, str]


@dataclass(frozen=True)
class _Subject:
    request: ReportRequest
    target: Target
    host: Host
    model: str

    @property
    def topic(self) -> tuple[str, str, str]:
        return self.target.name, self.request.scene, self.model


def report(request: ReportRequest | None = None, session: Session | None = None) -> Reported:
    """Lay out a stored sweep and what was measured as one page.

    Raises InputError where nothing is stored, or where this machine is not the CPU to measure.
    """
    session, asked = session or Session(), request or ReportRequest()
    model = _model(asked.scene, asked.model)
    known = _known(_Subject(asked, *resolve_target(asked.target), model), session)
    made = make_report(known)
    page = render(made.document, made.plots)
    return Reported(page, json_of(made.document) + "\n", made.missing)


def _known(about: _Subject, session: Session) -> Known:
    """What is stored, and with `seconds` what is measured first. InputError: nothing is known."""
    asked = about.request
    place = asked.store or default_store(session.cache)
    stored = read_stored(place, *about.topic) if asked.store or place.exists() else Stored()
    kept = findings_path(session.cache, *about.topic)
    if asked.seconds is not None:
        write_findings(kept, _measured(about, stored, asked.seconds, session))
    findings = read_findings(kept)
    if not stored.trials and findings is None:
        raise InputError(_nothing(about, place))
    commands = [*dict.fromkeys(run.command for run in stored.runs)]
    commands += [findings.command] if findings else []
    return Known(
        *about.topic,
        cpu=findings.cpu if findings else about.host.cpu,
        stored=stored,
        findings=findings,
        timings=session.timings(),
        commands=(*commands, f"./gen report{asked.options} --out {asked.out.name}"),
        made_at=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def _nothing(about: _Subject, place: Path) -> str:
    """What was looked for, and the commands that make it: here, or on such a CPU alone."""
    options, out = about.request.options, about.request.out
    sweep = f"./gen sweep{options}"
    head = f"{place}: nothing stored for {', '.join(about.topic)}; "
    if about.host.target.name == about.target.name:
        return f"{head}run {sweep}, or ./gen report{options} --out {out} --measure"
    own = f"./gen report --measure, which times this CPU ({about.host.target.name})"
    return f"{head}run {sweep} on a {about.target.name} and bring its store here, or here {own}"


def _measured(about: _Subject, stored: Stored, seconds: float, session: Session) -> Findings:
    target, scene, model = about.target, about.request.scene, about.model
    if about.host.target.name != target.name:
        raise InputError(
            f"--measure --target {target.name}: this machine is {about.host.target.name}, and a "
            "time taken on another CPU is never the target's; expected --target native"
        )
    command = f"./gen report{about.request.options} --measure --seconds {seconds:g}"
    order = Order(target, about.host, scene, model, seconds, command)
    place, finals = session.generated, stored.finals
    with session.workbench() as bench:
        found = subjects(place, target, scene, model, bench.compilers, finals)
        called = calls(found, finals, lanes_in(place, target, scene, model))
        return run_experiments(bench, found, called, order)


def measure_plot(
    target: str = "native",
    scene: str = "any",
    model: str | None = None,
    seconds: float = 60.0,
    session: Session | None = None,
) -> SpeedError:
    """Time against error of fixed steps and exact steppers, measured here for `seconds`.

    Raises InputError where the scene fixes parameters, KernelError where the code cannot run here.
    """
    session = session or Session()
    known = _model(scene, model)
    if find_impact(DEFAULT_IMPACT).find_scene(scene).fixed:
        raise InputError(f"--scene {scene}: fixes parameters; expected any, which the plot times")
    resolved, host = resolve_target(target)
    require_runs(host, resolved)
    with session.workbench() as bench:
        place = session.generated
        return measure_speed_error(bench, place, resolved, scene, known, seconds)


def plot_text(measured: SpeedError) -> tuple[str, str]:
    """The picture of what was measured as SVG, and its data as JSON."""
    data = json.dumps(measured.document(), indent=1) + "\n"
    return speed_error_svg.draw(measured), data


def read_plot(source: Path) -> SpeedError:
    """What `plot_text` gave as data. Raises InputError where a file is no such thing."""
    try:
        return speed_error_of(json.loads(source.read_text("utf-8")))
    except OSError as error:
        raise InputError(f"{source}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise InputError(f"{source}: not what gen plot wrote: {error}") from None


def model_gaps(session: Session | None = None) -> dict[tuple[str, str], Any]:
    """How far the contact models of the default impact differ, by model and spin."""
    tool = build_bench_tool((session or Session()).cache)
    gaps: dict[tuple[str, str], Any] = tool.impact.part("picture").model_gaps(tool)
    return gaps


def plot_models(impact: str | None = None, session: Session | None = None) -> Drawn:
    """How far the models of an impact differ: a picture, and what it shows in words."""
    found = find_impact(impact or DEFAULT_IMPACT)
    return models_picture(build_bench_tool((session or Session()).cache, impact=found))


def scene_costs(
    target: str = "native", seconds: float = 3.0, session: Session | None = None
) -> list[SceneCost]:
    """What each scene saves beside scene `any`, in operations and in time.

    `seconds`: of timing each. Raises KernelError where a kernel cannot be compared.
    """

    resolved, host = resolve_target(target)
    require_runs(host, resolved)
    names = [name for name in find_impact(DEFAULT_IMPACT).scene_table() if name != PLAIN]
    with (session or Session()).workbench() as bench:
        return costs_of(bench, resolved, names, seconds)


def _model(scene: str, model: str | None) -> str:
    """The name of a model, None: the scene's. InputError where there is none such."""
    impact = find_impact(DEFAULT_IMPACT)
    return impact.find_model(model or impact.find_scene(scene).model).name
