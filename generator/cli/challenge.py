"""gen challenge: look for the input with the largest error of a chosen kernel."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from generator.errors import InputError, KernelError

if TYPE_CHECKING:
    from generator.challenge.search import Finding, Result
    from generator.choice.workbench import Workbench
    from generator.targets.target import Target
    from generator.variants.variant import Variant

_MOST = 2**62  # evaluations, where the time alone ends a search


@click.command()
@click.argument("kernel", required=False)
@click.option("--target", default="native", show_default=True, help="CPU whose kernel to try")
@click.option("--scene", default="any", show_default=True, help="what is known of a shot")
@click.option("--model", help="contact model; default: the scene's")
@click.option("--max-error", type=float, help="error budget; default: the scene's")
@click.option("--batch", is_flag=True, help="the kernel for batches, in lanes")
@click.option(
    "--envelope",
    "extent",
    type=click.Choice(["real", "scene"]),
    default="scene",
    show_default=True,
    help="search what occurs in play, or all that the scene documents",
)
@click.option("--minutes", type=click.FloatRange(0.01, 100_000), help="time to search [default: 1]")
@click.option(
    "--evaluations",
    type=click.IntRange(1, _MOST),
    help="end after so many, whatever they take: the same seed then finds the same",
)
@click.option("--seed", default=1, show_default=True, type=click.IntRange(0, 2**31 - 1))
@click.option("--json", "json_path", type=click.Path(path_type=Path), help="write all of it")
@click.option("--keep", "keeps", is_flag=True, help="add what is over to the kept cases")
def challenge(
    kernel: str | None,
    target: str,
    scene: str,
    model: str | None,
    max_error: float | None,
    batch: bool,
    extent: Literal["real", "scene"],
    minutes: float | None,
    evaluations: int | None,
    seed: int,
    json_path: Path | None,
    keeps: bool,
) -> int:
    """Search for the input with the largest error of the chosen kernel, or of KERNEL."""
    import time

    from generator.challenge.document import document
    from generator.challenge.envelope import envelope
    from generator.challenge.kept import KEPT, keep
    from generator.challenge.search import Limits, search
    from generator.choice.lookup import require_runs
    from generator.cli.session import resolve_target, workbench
    from generator.files import require_place, write_file
    from generator.scenes.models import find_model
    from generator.scenes.scene import find_scene
    from generator.steppers.budgets import plan_for
    from generator.targets.target import find_target

    budget = max_error or find_scene(scene).max_error
    plan_for(budget)
    name = find_model(model or find_scene(scene).model).name
    variant = _named(kernel) if kernel else _chosen(target, scene, name, budget, batch)
    resolved, host = resolve_target(variant.target)
    require_runs(host, find_target(resolved.name))
    if json_path is not None:
        require_place(json_path)
    assert variant.stepper.budget is not None
    batch = batch or (kernel is not None and variant.width > 1)
    within = envelope(find_scene(variant.scene), variant.model, extent)
    with workbench(target=resolved) as bench:
        library = _built(bench, variant, resolved)
        until = float("inf") if evaluations else time.monotonic() + 60 * (minutes or 1.0)
        limits = Limits(evaluations or _MOST, until)
        found = search(bench.tool, library, within, variant.stepper.budget, batch, limits, seed)
    told = document(variant, within, batch, seed, host.cpu, found)
    _show(told["kernel"], variant.stepper.budget, extent, seed, found)
    if json_path is not None:
        import json

        write_file(json_path, json.dumps(told, indent=1) + "\n")
        click.echo(f"written: {json_path}")
    if keeps and found.over:
        count = keep([("found_by_search", found.over[0].case)])
        click.echo(f"{count} case added to {KEPT}")
    return 0 if found.held else 1


def _named(kernel: str) -> Variant:
    from generator.variants.names import variant_named

    variant = variant_named(kernel)
    if variant.stepper.budget is None:
        raise InputError(f"{kernel}: has fixed steps and no error budget; name an exact kernel")
    return variant


def _chosen(target: str, scene: str, model: str, budget: float, batch: bool) -> Variant:
    from generator.choice.lookup import Goal, batch_kernel_for, kernel_for
    from generator.cli.session import ROOT, resolve_target

    find = batch_kernel_for if batch else kernel_for
    resolved = resolve_target(target)[0]
    return find(ROOT / "generated", target, resolved, scene, model, Goal(None, budget))


def _built(bench: Workbench, variant: Variant, target: Target) -> Path:
    from generator.choice.lookup import with_compiler_found

    variant = with_compiler_found(variant, dict(bench.compilers))
    candidate = bench.prepare([variant], target)[0]
    bench.compile([candidate])
    if candidate.library is None:
        raise KernelError(candidate.rejected)
    return candidate.library.path


def _show(name: str, budget: float, extent: str, seed: int, found: Result) -> None:
    from generator.challenge.kept import CSV_HEADER, csv_row, hexfloats

    click.echo(f"{name}: envelope {extent}, seed {seed}")
    click.echo(f"{found.evaluations} evaluations, {found.per_second:.0f} a second")
    verdict = "within the budget" if found.held else "OVER"
    click.echo(f"worst error: {found.worst.over:.4g} of the budget {budget:g} ({verdict})")
    for finding in (*found.over[1:], *found.apart):
        click.echo(f"  {_line(finding)}")
    click.echo(f"worst case:\n{CSV_HEADER}\n{csv_row('found_by_search', found.worst.case)}")
    click.echo(hexfloats(found.worst.case))


def _line(finding: Finding) -> str:
    what = {
        "error": "over",
        "refused": "refused though valid",
        "steep": "steep, not counted",
        "floor": "under the doubles' floor, not counted",
    }[finding.kind]
    u_b, u_s, e_b = finding.case[4], finding.case[2], finding.case[5]
    return (
        f"{what}: {finding.over:.4g} of the budget, status {finding.status}; a rounding moves the "
        f"exact result by {finding.moved:.1e}; u_b {u_b:.6g} u_s {u_s:.6g} e_b {e_b:.6g}"
    )
