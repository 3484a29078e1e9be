"""gen challenge: look for the input with the largest error of a chosen kernel."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from .. import api
from ..files import require_place, write_file
from . import options
from .show import session

_REQUEST = ("impact", "target", "scene", "model", "max_error", "batch")


@click.command()
@click.argument("kernel", nargs=-1, metavar="[QUESTION [RECIPE]]")
@options.IMPACT
@options.TARGET
@options.SCENE
@options.MODEL
@options.MAX_ERROR
@options.BATCH
@click.option("--all", "everything", is_flag=True, help="all models and budgets, calls and batches")
@click.option(
    "--envelope",
    "extent",
    type=click.Choice(["real", "scene"]),
    default="scene",
    show_default=True,
    help="search what occurs in play, or all that the scene documents",
)
@click.option("--minutes", type=click.FloatRange(0.01, 100_000), help="a kernel  [default: 1]")
@click.option(
    "--evaluations",
    type=click.IntRange(1000, 2**62),
    help="end after so many instead: the same seed then finds the same",
)
@click.option("--seed", default=1, show_default=True, type=click.IntRange(0, 2**30))
@click.option("--json", "json_path", type=options.PLACE, help="write all of it")
@click.option("--keep", "keeps", is_flag=True, help="add what is over to the kept cases")
def challenge(
    kernel: tuple[str, ...],
    everything: bool,
    json_path: Path | None,
    keeps: bool,
    **asked: Any,
) -> int:
    """Search for the input with the largest error of the chosen kernel, or of another."""
    from ..evidence.verification.evidence import evidence_of
    from .challenge_lines import brief_line, lines

    own = {key: asked.pop(key) for key in _REQUEST}
    request = api.ChallengeRequest(
        api.Request(**own), " ".join(kernel) or None, everything, **asked
    )
    if json_path is not None:
        require_place(json_path)
    documents, held = [], True
    with session() as told:
        for found in api.challenge(request, told):
            documents.append(found.document)
            impact = found.subject.tool.impact
            shown = [brief_line(found)] if everything else lines(found)
            click.echo("\n".join(shown))
            held = held and found.held
            if keeps and any(result.over for result in found.results):
                new, over = api.keep(found.results, impact.name)
                click.echo(f"{new} of {over} cases added to {evidence_of(impact).hard_cases}")
            if json_path is not None:
                text = json.dumps({"schema": 1, "searches": documents}, indent=1)
                write_file(json_path, text + "\n")
    return 0 if held else 1
