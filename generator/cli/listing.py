"""gen list targets|scenes|variants|models."""

from __future__ import annotations

import click

from ..errors import InputError


@click.command("list")
@click.argument("what", type=click.Choice(["targets", "scenes", "variants", "models"]))
@click.option("--cost", is_flag=True, help="of scenes: operations and times, measured here")
@click.option("--target", default="native", show_default=True, help="CPU that --cost is for")
@click.option(
    "--seconds",
    default=3.0,
    show_default=True,
    type=click.FloatRange(0.1, 600),
    help="time for timing each scene with --cost",
)
def list_rows(what: str, cost: bool, target: str, seconds: float) -> None:
    """List what there is to choose from."""
    if cost:
        from .scene_table import show_scene_costs

        if what != "scenes":
            raise InputError(f"--cost: {what} have none; expected list scenes --cost")
        show_scene_costs(target, seconds)
        return
    from .tables import show_tables

    show_tables(what)
