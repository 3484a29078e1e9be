"""gen list scenes --cost: what each scene saves, in operations and in time."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from ..choice.lookup import require_runs
from ..impacts.ball_ball.scene import scenes
from ..report.figures.scene_costs import COUNTED_CASES, PLAIN, SceneCost, scene_costs
from .session import resolve_target, workbench

_TITLES = (
    "scene",
    "E",
    "flops a step\n(any)",
    "flops a collision\n(any)",
    "ratio",
    "ns a collision\n(any)",
    "ratio (95 %)",
)


def show_scene_costs(target_name: str, seconds: float) -> None:
    """Measure and print. Raises KernelError where a kernel cannot be compared."""
    target, host = resolve_target(target_name)
    require_runs(host, target)
    names = [name for name in scenes() if name != PLAIN]
    with workbench() as bench:
        costs = scene_costs(bench, target, names, seconds)
    table = Table(*_TITLES, title_justify="left", show_edge=False)
    for cost in costs:
        table.add_row(*_row(cost))
    console = Console()
    console.print(table)
    console.print(
        f"each beside the kernel of scene {PLAIN} for the same model and E, on the scene's cases; "
        f"flops: counted while {COUNTED_CASES} of them run, an FMA being two; {target.name} code, "
        f"timed on {host.cpu}",
        highlight=False,
    )


def _row(cost: SceneCost) -> tuple[str, ...]:
    low, high = cost.ratio_ci
    return (
        cost.scene,
        f"{cost.budget:g}",
        f"{cost.step} ({cost.step_any})",
        f"{cost.collision.flops_per_collision:.0f} ({cost.collision_any.flops_per_collision:.0f})",
        f"{cost.flops_ratio:.3f}",
        f"{cost.ns:.0f} ({cost.ns_any:.0f})",
        f"{cost.ratio:.3f} ({low:.3f}-{high:.3f})",
    )
