"""gen explain KERNEL: the derivation, the options and the operation counts of a kernel."""

from __future__ import annotations

import click

from ..impacts.ball_ball.models import DEFAULT_MODEL


@click.command()
@click.argument("kernel")
@click.option("--target", default="x86-64-v3", show_default=True, help="for a preset")
@click.option("--model", default=DEFAULT_MODEL, show_default=True, help="for a preset")
def explain(kernel: str, target: str, model: str) -> None:
    """Explain a kernel, by its name, its file or a preset (see list variants)."""
    from .explanation import print_explanation

    print_explanation(kernel, target, model)
