"""gen vendor: kernels as a folder that builds alone in another project."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .. import api
from ..errors import InputError
from ..impacts import DEFAULT
from . import options
from .show import session

if TYPE_CHECKING:
    from ..choice.selection import Selected


@click.command()
@click.option("--target", help="CPUs with commas, as zen3,x86-64-v3; several get a dispatcher")
@click.option(
    "--impact",
    default=DEFAULT,
    show_default=True,
    help="what collides, several with commas (list impacts)",
)
@options.SCENE
@click.option("--model", help="contact model, or one an impact with commas; default: the scene's")
@options.MAX_ERROR
@options.STEPS
@click.option("--prefix", default="carom", show_default=True, help="what all names begin with")
@click.option("--out", type=options.PLACE, help="folder to write")
@click.option("--single-header", is_flag=True, help="all in one header")
@click.option("--reproducible", is_flag=True, help="the same bits on every CPU: no estimated roots")
@click.option("--force", is_flag=True, help="replace a folder that was edited by hand")
@options.seconds(10.0, "where no choice is stored yet")
@click.option(
    "--verify",
    type=options.PLACE,
    help="is a vendored folder unchanged, edited by hand, or out of date?",
)
@click.pass_context
def vendor(
    context: click.Context,
    /,
    target: str | None,
    out: Path | None,
    verify: Path | None,
    **asked: Any,
) -> int:
    """Write chosen kernels as a folder that builds alone, or verify such a folder."""
    if verify is not None:
        others = [name for name in options.given(context) if name != "--verify"]
        if others:
            raise InputError(f"--verify DIR takes all from the folder; remove {others[0]}")
        return _verify(verify)
    if target is None or out is None:
        missing = "--target" if target is None else "--out"
        raise InputError(f"vendor: no {missing}; as ./gen vendor --target zen3,x86-64-v3 --out DIR")
    names = tuple(name.strip() for name in target.split(","))
    with session() as told:
        made = api.vendor(api.VendorOptions(names, **asked), out, told)
    for of_impact in made.kernels.values():
        for name, kernels in of_impact.items():
            click.echo(f"{name}: {_line(kernels.single)}")
            if kernels.batch is not None:
                click.echo(f"{name}, batches: {_line(kernels.batch)}")
    click.echo(f"{made.files} files written: {out}/")
    return 0


def _line(entry: Selected) -> str:
    error = "not verified here"
    if entry.max_rel_error is not None:
        impact = entry.variant.question.row
        error = f"largest error seen {entry.max_rel_error:g} of {impact.relative_to}"
    return f"{entry.kernel}, chosen by {entry.chosen_by} on {entry.measured_on}; {error}"


def _verify(folder: Path) -> int:
    with session() as told:
        found = api.verify_vendored(folder, told)
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
