"""gen collide: run collisions of a CSV file through the chosen kernel."""

from __future__ import annotations

from pathlib import Path

import click

from ..errors import InputError


@click.command()
@click.option("--cases", required=True, type=click.Path(path_type=Path), help="CSV of cases")
@click.option("--out", required=True, type=click.Path(path_type=Path), help="CSV to write")
@click.option("--model", help="contact model; default mathavan2014")
@click.option("--target", default="native", show_default=True, help="CPU whose kernel to run")
@click.option("--steps", type=click.IntRange(1, 100_000_000), help="fixed steps, as pooltool")
@click.option("--max-error", type=float, help="error budget instead of fixed steps")
@click.option("--batch", is_flag=True, help="through the batch kernel, in lanes")
def collide(
    cases: Path,
    out: Path,
    model: str | None,
    target: str,
    steps: int | None,
    max_error: float | None,
    batch: bool,
) -> None:
    """Collide the cases of a CSV file."""
    from ..choice.lookup import (
        Goal,
        batch_kernel_for,
        kernel_for,
        require_runs,
        with_compiler_found,
    )
    from ..errors import KernelError
    from ..files import is_stdout, require_place, write_file
    from ..impacts.ball_ball.models import find_model
    from ..impacts.ball_ball.scene import find_scene
    from ..steppers.exact.budgets import plan_for
    from .case_table import outcome_text, read_case_table
    from .session import ROOT, resolve_target, workbench

    if steps is not None and max_error is not None:
        raise InputError("--steps and --max-error exclude each other: name one of them")
    model_name = find_model(model or find_scene("any").model).name
    resolved, host = resolve_target(target)
    table = read_case_table(cases)
    require_place(out)
    require_runs(host, resolved)
    budget = None if steps is not None else max_error or find_scene("any").max_error
    if budget is not None:
        plan_for(budget)
    goal = Goal(steps, budget)
    find = batch_kernel_for if batch else kernel_for
    variant = find(ROOT / "generated", target, resolved, "any", model_name, goal)
    with workbench() as bench:
        variant = with_compiler_found(variant, bench.compilers)  # type: ignore[arg-type]
        candidate = bench.prepare([variant], resolved)[0]
        bench.compile([candidate])
        if candidate.library is None:
            raise KernelError(candidate.rejected)
        own = variant.stepper.steps == steps
        outcomes = bench.tool.run_kernel(
            candidate.library.path,
            table.rows,
            steps=None if own else steps,
            batch=batch,
            timeout=60.0 + 1e-7 * (steps or 10_000) * len(table.rows),
        )
    write_file(out, outcome_text(table.ids, outcomes))
    good = int((outcomes[:, 12] == 0).sum())
    told = f"{len(table.ids)} cases, {good} collided, by {candidate.name}; written: {out}"
    click.echo(told, err=is_stdout(out))
