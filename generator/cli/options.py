"""Options that several verbs take, each written once: the same word means the same everywhere."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from ..impacts import DEFAULT

Command = TypeVar("Command", bound=Callable[..., Any])

PLACE = click.Path(path_type=Path)
TARGET = click.option(
    "--target", default="native", show_default=True, help="CPU: native, zen3, ... (list targets)"
)
IMPACT = click.option(
    "--impact", default=DEFAULT, show_default=True, help="what collides (list impacts)"
)
SCENE = click.option(
    "--scene", default="any", show_default=True, help="what is known of a shot (list scenes)"
)
MODEL = click.option("--model", help="contact model (list models); default: the scene's")
MAX_ERROR = click.option(
    "--max-error",
    type=float,
    help="error budget, relative to the relative speed; default: the scene's",
)
STEPS = click.option(
    "--steps", type=click.IntRange(1, 10**8), help="fixed steps instead, so many, as pooltool"
)
BATCH = click.option("--batch", is_flag=True, help="the kernel for batches, in lanes")
STORE = click.option("--store", type=PLACE, help="store of a sweep; default: that in the cache")
JSON = click.option("--json", "as_json", is_flag=True, help="print JSON instead of a table")


def seconds(usual: float, of: str, least: float = 0.1) -> Callable[[Command], Command]:
    """--seconds: the time that is spent on timing."""
    return click.option(
        "--seconds",
        default=usual,
        show_default=True,
        type=click.FloatRange(least, 3600),
        help=f"for timing {of}",
    )


def given(context: click.Context) -> list[str]:
    """The options that the user gave, as they are written."""
    source = click.core.ParameterSource.COMMANDLINE
    params = [p for p in context.command.params if isinstance(p, click.Option)]
    found = [p for p in params if context.get_parameter_source(p.name or "") is source]
    return [max(p.opts, key=len) for p in found]
