"""gen vendor: kernels as a folder that builds alone in another project."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import InputError

if TYPE_CHECKING:  # the rest is imported when the command runs: --help shall not wait for it
    from ..choice.selection import Selected
    from ..vendoring.kernels import Places, TargetKernels
    from ..vendoring.request import VendorRequest


@click.command()
@click.option("--target", help="CPUs with commas, as zen3,x86-64-v3; several get a dispatcher")
@click.option("--scene", default="any", show_default=True, help="what is known of a shot")
@click.option("--model", help="contact model; default: the scene's")
@click.option("--max-error", type=float, help="error budget; default: the scene's")
@click.option("--steps", type=click.IntRange(1, 1_000_000), help="fixed steps instead, as pooltool")
@click.option("--prefix", default="carom", show_default=True, help="what all names begin with")
@click.option("--out", type=click.Path(path_type=Path), help="folder to write")
@click.option("--single-header", is_flag=True, help="all in one header")
@click.option("--reproducible", is_flag=True, help="the same bits on every CPU: no estimated roots")
@click.option("--force", is_flag=True, help="replace a folder that was edited by hand")
@click.option(
    "--seconds",
    default=10.0,
    show_default=True,
    type=click.FloatRange(0.1, 3600),
    help="time for timing, where no choice is stored yet",
)
@click.option(
    "--verify",
    type=click.Path(path_type=Path),
    help="is a vendored folder unchanged, edited by hand, or out of date?",
)
def vendor(
    target: str | None,
    scene: str,
    model: str | None,
    max_error: float | None,
    steps: int | None,
    prefix: str,
    out: Path | None,
    single_header: bool,
    reproducible: bool,
    force: bool,
    seconds: float,
    verify: Path | None,
) -> int:
    """Write chosen kernels as a folder that builds alone, or verify such a folder."""
    from ..choice.lookup import Goal
    from ..vendoring.request import checked_targets, make_request

    context = click.get_current_context()
    if verify is not None:
        given = [p.name for p in context.command.params if _is_given(context, p.name)]
        others = [f"--{name.replace('_', '-')}" for name in given if name != "verify"]
        if others:
            raise InputError(f"--verify DIR takes all from the folder; remove {others[0]}")
        return _verify(verify)
    if target is None or out is None:
        missing = "--target" if target is None else "--out"
        raise InputError(f"vendor: no {missing}; as ./gen vendor --target zen3,x86-64-v3 --out DIR")
    names = checked_targets(target, _native(target))
    goal = Goal(steps, max_error)
    return _write(
        make_request(names, scene, model, goal, prefix, single_header, reproducible),
        out,
        force,
        seconds,
    )


def _native(names: str) -> str:
    """This machine's target, where it is asked for."""
    from .session import resolve_target

    return resolve_target("native")[0].name if "native" in names.split(",") else ""


def _is_given(context: click.Context, name: str | None) -> bool:
    source = context.get_parameter_source(name or "")
    return source is click.core.ParameterSource.COMMANDLINE


def _places() -> Places:
    from ..places import cache_folder
    from ..vendoring.kernels import Places
    from .session import ROOT

    return Places(ROOT / "generated", cache_folder() / "selections")


def _kernels(request: VendorRequest, target: str, seconds: float) -> TargetKernels:
    """The stored choice, else one made now, by the compilers of the target's architecture."""
    from ..targets.host import read_host
    from ..targets.target import find_target
    from ..vendoring.kernels import kernels_for, stored_kernels
    from .session import workbench

    if (stored := stored_kernels(_places(), request, target)) is not None:
        return stored
    with workbench(target=find_target(target)) as bench:
        bench.reproducible = request.reproducible
        return kernels_for(_places(), request, target, bench, read_host(), seconds)


def _write(request: VendorRequest, out: Path, force: bool, seconds: float) -> int:
    from ..vendoring.folder import require_replaceable, staged, write_files
    from ..vendoring.job import all_files
    from .session import workbench

    require_replaceable(out, edited_too=force)
    chosen = {name: _kernels(request, name, seconds) for name in request.targets}
    with workbench() as bench:
        files = all_files(request, chosen, bench.tool)
    with staged(out) as folder:
        write_files(folder, files)
    for name, kernels in chosen.items():
        click.echo(f"{name}: {_line(kernels.single)}")
        if kernels.batch is not None:
            click.echo(f"{name}, batches: {_line(kernels.batch)}")
    click.echo(f"{len(files)} files written: {out}/")
    return 0


def _line(entry: Selected) -> str:
    error = "not verified here"
    if entry.max_rel_error is not None:
        error = f"largest error seen {entry.max_rel_error:g} of the relative speed"
    return f"{entry.kernel}, chosen by {entry.chosen_by} on {entry.measured_on}; {error}"


def _verify(folder: Path) -> int:
    from ..vendoring.job import compare
    from ..vendoring.manifest import read_manifest
    from .session import workbench

    read_manifest(folder)
    with workbench() as bench:
        found = compare(folder, _places(), bench.tool)
    for change in found.by_hand:
        click.echo(f"{folder / change.name}: {change.what} by hand")
    for reason in found.outdated:
        click.echo(f"{folder}: {reason}")
    if found.unchanged:
        click.echo(f"{folder}: unchanged, and what ./gen vendor gives today")
        return 0
    states = ["edited by hand"] * bool(found.by_hand) + ["out of date"] * bool(found.outdated)
    click.echo(f"{folder}: {' and '.join(states)}; made by {found.manifest.command}")
    return 1
