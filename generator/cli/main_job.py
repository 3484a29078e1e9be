"""The main job: derive, emit, compile, verify, time or model, choose, write."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from ..choice.batches import batch_job
from ..choice.choose import Choice, selected
from ..choice.folder import checked_selection, require_writable, write_folder
from ..choice.job import EMULATED, exact_job, fixed_step_job
from ..choice.selection import Selection
from ..choice.workbench import (
    VERIFY_RANDOM,
    VERIFY_SEED,
    Candidate,
    Workbench,
)
from ..impacts.ball_ball.models import MODELS, find_model
from ..impacts.ball_ball.scene import find_scene
from ..steppers.exact.budgets import plan_for
from ..targets.host import Host
from ..targets.target import Target
from .main_table import LEAST_WIDTH, show_table
from .session import ROOT, resolve_target, workbench


def run_main_job(
    target_name: str,
    scene: str,
    model: str | None,
    out: Path | None,
    seconds: float,
    fresh: bool = False,
    max_error: float | None = None,
) -> None:
    """Everything that `./gen --target T` does; model `all` does it for each in turn."""
    target, host = resolve_target(target_name)
    known = find_scene(scene)
    names = [m.name for m in MODELS] if model == "all" else [find_model(model or known.model).name]
    plan_for(max_error or known.max_error)
    folder = (out or ROOT / "generated") / target_name / scene
    checked_selection(folder)  # what is wrong with it shall be said before the work, not after
    require_writable(folder)
    console = Console()
    if console.width < LEAST_WIDTH:
        console.width = LEAST_WIDTH
    with workbench(fresh=fresh, target=target) as bench:
        for name in names:
            jobs = [fixed_step_job] if max_error is None and known.fixed_steps else []
            for job in [*jobs, exact_job(max_error or known.max_error)]:
                candidates, first, choice = job(bench, target, host, scene, name, seconds)
                batches = batch_job(bench, target, host, scene, first, choice.chosen, seconds)
                selection = checked_selection(folder) or Selection(
                    target=target_name, resolved=target.name, scene=scene, kernels=[]
                )
                selection = selection.model_copy(update={"resolved": target.name})
                found = [(candidates, first, choice), *([batches] if batches else [])]
                entries = [selected(chosen, base) for _, base, chosen in found]
                write_folder(folder, selection.with_entries(entries))
                for (shown, _, chosen), entry in zip(found, entries, strict=True):
                    console.print(f"\nmodel {name}, {_goal(chosen)}", highlight=False)
                    show_table(console, shown, chosen, target)
                    _footnotes(console, bench, shown, chosen, target, host)
                    written = f"written: {folder}/ ({entry.file})"
                    console.print(written, highlight=False, soft_wrap=True)


def _goal(choice: Choice) -> str:
    stepper, batches = choice.chosen.variant.stepper, choice.chosen.is_batch
    if stepper.steps is not None:
        return f"{'batches' if batches else 'fixed steps'}, N = {stepper.steps}"
    return f"{'batches, ' * batches}exact to {stepper.budget:g} of the relative speed"


def _footnotes(
    console: Console,
    bench: Workbench,
    candidates: list[Candidate],
    choice: Choice,
    target: Target,
    host: Host,
) -> None:
    def say(text: str) -> None:
        console.print(text, highlight=False, markup=False, soft_wrap=True)

    verdict, pooltool = choice.chosen.verdict, choice.chosen.pooltool
    assert verdict is not None
    which = f"reference, and {VERIFY_RANDOM} random ones with seed {VERIFY_SEED}"
    if bench.emulated is not None:
        which = f"every {EMULATED}th of: {which}"
    say(f"verified on {verdict.cases} cases ({which}); the chosen kernel: {verdict.reason}")
    labels = bench.labels
    for flip in verdict.flips:
        say(f"  flip by a step: {labels[flip]}")
    if pooltool is not None:
        say(
            f"against pooltool's own figures (euler_n1000.csv, {pooltool.cases} cases): "
            f"{pooltool.reason}; largest difference {pooltool.max_abs_error:.1e} m/s"
        )
        for flip in pooltool.flips:
            say(f"  flip by a step: {labels[flip]}")
    first = candidates[0].variant
    if first.scene != choice.chosen.variant.scene:
        say(
            f"scene {choice.chosen.variant.scene} has no fixed-step kernels (that scheme is of "
            f"equal balls and in double): paper-initial is that of scene {first.scene}"
        )
    if bench.emulated is not None:
        say(
            f"{target.name} is of another architecture: run under "
            f"{Path(bench.emulated.emulator[0]).name}, and no time is known of it"
        )
    if choice.chosen.modelled is not None:
        say(_grounds(choice, target, host))
    say(f"grounds: {choice.evidence}")
    if choice.sought is not None:
        say(f"search for errors: {choice.sought} (gen challenge searches longer)")
    for note in sorted({f"{c.compiler.code}: {c.march_note}" for c in candidates if c.march_note}):
        say(note)
    if counts := bench.reused():
        say(f"reused from earlier runs: {counts} (--fresh verifies and times anew)")
    say(f"chosen: {choice.chosen.name}")
    say(f"ties with it: {len(choice.ties) - 1}")


def _grounds(choice: Choice, target: Target, host: Host) -> str:
    """What the figures of llvm-mca are."""
    head = f"{target.name} is not this host's CPU ({host.target.name}): llvm-mca's cycles for"
    return (
        f"{head} {target.row.mca_cpu} are a collision's, the instructions that "
        f"{_replayed(choice)} executed here replayed (branches guessed rightly, memory in the "
        "nearest cache): a model's figure, not a time"
    )


def _replayed(choice: Choice) -> str:
    """What llvm-mca's figures are the mean of."""
    figures = choice.chosen.modelled
    assert figures is not None
    return f"{figures.cases} cases of the mixed set"
