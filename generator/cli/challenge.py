"""gen challenge: look for the input with the largest error of a chosen kernel."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from ..errors import InputError, KernelError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..choice.workbench import Workbench
    from ..evidence.challenge.search import Limits, Result, Subject
    from ..registry.variant import Variant

_MOST = 2**62  # evaluations, where the time alone ends a search
_BUDGETS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-9)  # of --all


@dataclass(frozen=True)
class _Asked:
    """What to search, as it was asked for."""

    target: str
    scene: str
    extent: Literal["real", "scene"]
    seed: int
    minutes: float | None
    evaluations: int | None

    def limits(self) -> Limits:
        import time

        from ..evidence.challenge.search import Limits

        if self.evaluations is not None:
            return Limits(self.evaluations)
        return Limits(_MOST, time.monotonic() + 60 * (self.minutes or 1.0))


@click.command()
@click.argument("kernel", required=False)
@click.option("--target", default="native", show_default=True, help="CPU whose kernel to try")
@click.option("--scene", default="any", show_default=True, help="what is known of a shot")
@click.option("--model", help="contact model; default: the scene's")
@click.option("--max-error", type=float, help="error budget; default: the scene's")
@click.option("--batch", is_flag=True, help="the kernel for batches, in lanes")
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
    type=click.IntRange(1000, _MOST),
    help="end after so many instead: the same seed then finds the same",
)
@click.option("--seed", default=1, show_default=True, type=click.IntRange(0, 2**30))
@click.option("--json", "json_path", type=click.Path(path_type=Path), help="write all of it")
@click.option("--keep", "keeps", is_flag=True, help="add what is over to the kept cases")
def challenge(
    kernel: str | None,
    target: str,
    scene: str,
    model: str | None,
    max_error: float | None,
    batch: bool,
    everything: bool,
    extent: Literal["real", "scene"],
    minutes: float | None,
    evaluations: int | None,
    seed: int,
    json_path: Path | None,
    keeps: bool,
) -> int:
    """Search for the input with the largest error of the chosen kernel, or of KERNEL."""
    import json

    from ..choice.lookup import require_runs
    from ..evidence.challenge.document import document
    from ..evidence.challenge.search import search_all
    from ..files import require_place, write_file
    from .session import resolve_target, workbench

    if everything and kernel:
        raise InputError("--all and a KERNEL exclude each other: name one of them")
    if minutes is not None and evaluations is not None:
        raise InputError("--minutes and --evaluations exclude each other: name one of them")
    asked = _Asked(target, scene, extent, seed, minutes, evaluations)
    if kernel:
        wanted = [(_named(kernel), batch)]
    else:
        wanted = list(_chosen(asked, model, max_error, None if everything else batch))
    resolved, host = resolve_target(wanted[0][0].target)
    require_runs(host, resolved)
    if json_path is not None:
        require_place(json_path)
    documents, held = [], True
    with workbench(target=resolved) as bench:
        for variant, lanes in wanted:
            subject = _subject(
                bench, variant, lanes or (kernel is not None and variant.width > 1), extent
            )
            found = search_all(subject, asked.limits(), seed)
            documents.append(document(variant, subject, seed, host.cpu, found))
            held = _show(documents[-1]["kernel"], subject, seed, found, brief=everything) and held
            if keeps:
                _keep(found)
            if json_path is not None:
                text = json.dumps({"schema": 1, "searches": documents}, indent=1)
                write_file(json_path, text + "\n")
    return 0 if held else 1


def _named(kernel: str) -> Variant:
    from ..registry.names import variant_named

    variant = variant_named(kernel)
    if variant.stepper.budget is None:
        raise InputError(f"{kernel}: has fixed steps and no error budget; name an exact kernel")
    return variant


def _chosen(
    asked: _Asked, model: str | None, max_error: float | None, batch: bool | None
) -> Iterator[tuple[Variant, bool]]:
    """Chosen kernels and whether they are for batches. `batch` None: all that is not named."""
    from ..choice.lookup import Goal, batch_kernel_for, kernel_for
    from ..impacts.ball_ball.models import MODELS, find_model
    from ..impacts.ball_ball.scene import find_scene
    from ..steppers.exact.budgets import plan_for
    from .session import ROOT, resolve_target

    scene, resolved = find_scene(asked.scene), resolve_target(asked.target)[0]
    every = batch is None
    models = [m.name for m in MODELS] if every and not model else [model or scene.model]
    budgets = _BUDGETS if every and max_error is None else (max_error or scene.max_error,)
    for budget in budgets:
        plan_for(budget)
        scene.require_budget(budget)
    for name in models:
        find_model(name)
        for budget in budgets:
            for lanes in (False, True) if batch is None else (batch,):
                find = batch_kernel_for if lanes else kernel_for
                goal = Goal(None, budget)
                place = ROOT / "generated"
                yield find(place, asked.target, resolved, asked.scene, name, goal), lanes


def _subject(
    bench: Workbench, variant: Variant, batch: bool, extent: Literal["real", "scene"]
) -> Subject:
    import numpy as np

    from ..choice.lookup import with_compiler_found
    from ..evidence.challenge.envelope import envelope
    from ..evidence.challenge.search import Subject
    from ..evidence.profiling.counting import count_operations
    from ..evidence.verification.errors import Array
    from ..impacts.ball_ball.scene import find_scene
    from ..targets.target import find_target

    variant = with_compiler_found(variant, dict(bench.compilers))
    candidate = bench.prepare([variant], find_target(variant.target))[0]
    bench.compile([candidate])
    if candidate.library is None:
        raise KernelError(candidate.rejected)
    cache = bench.cache / "kernels"

    def count(cases: Array) -> Array:
        counted = count_operations(
            candidate.source, candidate.compiler, candidate.flags, cases, cache
        )
        return np.array(counted.each, dtype=np.float64)

    within = envelope(find_scene(variant.scene), variant.model, extent)
    budget = variant.stepper.budget
    assert budget is not None
    library = candidate.library.path
    return Subject(bench.tool, library, within, budget, batch, None if batch else count)


def _keep(found: list[Result]) -> None:
    from ..evidence.challenge.kept import keep
    from ..evidence.verification.hard_cases import FILE

    over = [("found_by_search", result.over[0].case) for result in found if result.over]
    if over:
        click.echo(f"{keep(over)} of {len(over)} cases added to {FILE}")


def _show(name: str, subject: Subject, seed: int, found: list[Result], brief: bool) -> bool:
    """Prints what was found; was nothing over?"""
    from .challenge_lines import brief_line, lines

    if brief:
        click.echo(brief_line(name, subject, found))
    else:
        click.echo("\n".join(lines(name, subject, seed, found)))
    return all(result.held for result in found)
