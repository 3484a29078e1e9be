"""gen list impacts|targets|scenes|variants|models."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from .. import api
from ..errors import InputError
from ..impacts import DEFAULT
from . import options
from .show import rows_of, session, show, three_digits

if TYPE_CHECKING:
    from ..api.listing import ModelRow
    from ..report.figures.scene_costs import SceneCost

_TITLES = {
    "axes": "option axes (the first choice is the default)",
    "lanes": "lanes of a vector, by the numbers in them",
    "rules": "combinations that are refused",
    "presets": "presets",
}


@click.command("list")
@click.argument("what", type=click.Choice(["impacts", "targets", "scenes", "variants", "models"]))
@options.IMPACT
@options.JSON
@click.option("--cost", is_flag=True, help="of scenes: operations and times, measured here")
@options.TARGET
@options.seconds(3.0, "each scene with --cost")
def list_rows(
    what: str, impact: str, as_json: bool, cost: bool, target: str, seconds: float
) -> None:
    """List what there is to choose from."""
    if impact != DEFAULT and (cost or what not in ("scenes", "models")):
        asked = "scenes --cost" if cost else what
        raise InputError(f"--impact {impact}: is for list scenes and list models, not {asked}")
    if cost:
        if what != "scenes":
            raise InputError(f"--cost: {what} have none; expected list scenes --cost")
        _show_costs(target, seconds, as_json)
    elif what == "variants":
        found = api.variants()
        tables = {key: rows_of(getattr(found, key)) for key in _TITLES}
        show(tables if as_json else {_TITLES[key]: rows for key, rows in tables.items()}, as_json)
    else:
        if what == "models":
            rows = [_model(row) for row in api.models(impact)]
        elif what == "scenes":
            rows = rows_of(api.scenes(impact))
        else:
            rows = rows_of({"impacts": api.impacts, "targets": api.targets}[what]())
        titles = {"models": "contact models", "targets": f"targets{_unknown_host()}"}
        show({titles.get(what, what): rows}, as_json)


def _model(row: ModelRow) -> dict[str, object]:
    """With a column for each term in which models differ."""
    return {"name": row.name, **row.terms, "what": row.what}


def _unknown_host() -> str:
    """What this machine's CPU is taken for, where it is none of the targets."""
    from ..targets.host import read_host

    host = read_host()
    told = f" ({host.cpu} is not known: native is its nearest ancestor, {host.target.name})"
    return "" if host.exact else told


def _show_costs(target: str, seconds: float, as_json: bool) -> None:
    with session() as told:
        costs = api.scene_costs(target, seconds, told)
    title = (
        "each scene beside `any` for the same model and E, on the scene's cases; flops: counted "
        "while cases run, an FMA being two; times: of this machine"
    )
    show({title: [_cost(cost) for cost in costs]}, as_json)


def _cost(cost: SceneCost) -> dict[str, object]:
    low, high = cost.speed.ratio_ci
    return {
        "scene": cost.scene,
        "E": cost.budget,
        "flops a step": cost.step,
        "flops a step, any": cost.step_any,
        "flops a collision": round(cost.collision.flops_per_collision),
        "flops a collision, any": round(cost.collision_any.flops_per_collision),
        "flops ratio": three_digits(cost.flops_ratio),
        "ns": round(cost.speed.ns),
        "ns, any": round(cost.ns_any),
        "ns ratio": three_digits(cost.speed.ratio),
        "95 %": f"{three_digits(low)}-{three_digits(high)}",
    }
