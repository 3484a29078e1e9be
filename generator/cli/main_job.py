"""The main job: derive, emit, compile, verify, time or model, choose, write."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.table import Table

from generator.choice.candidates import baseline, fixed_step_candidates
from generator.choice.choose import Choice, choose_by_model, choose_by_time, selected
from generator.choice.folder import write_folder
from generator.choice.selection import Selection, read_selection
from generator.choice.workbench import VERIFY_RANDOM, VERIFY_SEED, Candidate, Workbench
from generator.cli.session import ROOT, resolve_target, workbench
from generator.scenes.models import find_model
from generator.scenes.scene import find_scene
from generator.targets.host import Host
from generator.targets.target import Target
from generator.variants.names import name_of
from generator.variants.presets import PAPER_PRESETS
from generator.variants.variant import make_variant

STEPS = 1000
TIMING_SECONDS = 30.0


def run_main_job(
    target_name: str, scene: str, model: str | None, out: Path | None, seconds: float
) -> None:
    """Everything that `./gen --target T` does."""
    target, host = resolve_target(target_name)
    model = model or find_scene(scene).model
    find_model(model)
    folder = (out or ROOT / "generated") / target_name / scene
    previous = read_selection(folder)
    console = Console()
    with workbench() as bench:
        candidates, first, choice = fixed_step_job(bench, target, host, scene, model, seconds)
    entry = selected(choice, first)
    selection = previous or Selection(
        target=target_name, resolved=target.name, scene=scene, kernels=[]
    )
    selection = selection.model_copy(update={"resolved": target.name})
    write_folder(folder, selection.with_entries([entry]))
    _show(console, candidates, choice, target, host)
    console.print(f"written: {folder}/ ({entry.file})", highlight=False, soft_wrap=True)


def fixed_step_job(
    bench: Workbench, target: Target, host: Host, scene: str, model: str, seconds: float
) -> tuple[list[Candidate], Candidate, Choice]:
    """Candidates of the fixed-step scheme with their figures, the baseline, and the choice."""
    codes = list(bench.compilers)
    variants = fixed_step_candidates(target, scene, model, STEPS, codes)
    first = baseline(target, scene, model, STEPS, codes)
    variants = [first, *(v for v in variants if name_of(v) != name_of(first))]
    candidates = bench.prepare(variants, target)
    bench.compile(candidates)
    expected = bench.expected(scene, model, STEPS, VERIFY_SEED, VERIFY_RANDOM)
    runs_here = host.runs(target)
    is_host = runs_here and host.target.name == target.name and host.exact
    if runs_here:
        bench.verify(candidates, expected)
        run = bench.time(candidates, candidates[0], scene, seconds)
    if is_host:
        return candidates, candidates[0], choose_by_time(candidates, run, host.target.name)
    bench.model(candidates, target)
    return candidates, candidates[0], choose_by_model(candidates, target.row.mca_cpu)


def preset_of(candidate: Candidate) -> str:
    """The report's name for a candidate, or empty."""
    v = candidate.variant
    for preset in PAPER_PRESETS:
        same = make_variant(v.target, v.scene, v.model, v.stepper, **preset.options)
        if same.options == v.options:
            return preset.name
    return ""


def _show(
    console: Console, candidates: list[Candidate], choice: Choice, target: Target, host: Host
) -> None:
    here = host.target.name
    foreign = choice.by == "llvm-mca"
    title = f"{target.name}: speed against error, timed on {here} ({host.cpu})"
    table = Table(title=title, title_justify="left", show_edge=False)
    table.add_column("kernel options")
    if foreign:
        table.add_column(f"cycles/step\n{target.row.mca_cpu} (llvm-mca)", justify="right")
    table.add_column(f"ns\non {here}", justify="right")
    table.add_column("latency\nns", justify="right")
    table.add_column("ratio to\npaper-initial", justify="right")
    table.add_column("95 %\ninterval", justify="right")
    table.add_column("largest\nerror, m/s", justify="right")
    table.add_column("")
    ordered = sorted(candidates, key=lambda c: _rank(c, foreign))
    for candidate in ordered:
        table.add_row(*_row(candidate, choice, foreign))
    console.print(table)
    for candidate in ordered:
        if candidate.rejected:
            console.print(f"rejected {_label(candidate)}: {candidate.rejected}", highlight=False)
    _footnotes(console, candidates, choice, target, host)


def _footnotes(
    console: Console, candidates: list[Candidate], choice: Choice, target: Target, host: Host
) -> None:
    verdict = choice.chosen.verdict
    assert verdict is not None
    console.print(
        f"verified on {verdict.cases} cases (reference, and random with seed {VERIFY_SEED}): "
        f"{verdict.reason}",
        highlight=False,
    )
    if verdict.flips:
        console.print(f"flips of the chosen kernel, by case: {list(verdict.flips)}")
    if choice.by == "llvm-mca":
        console.print(
            f"{target.name} is not this host's CPU ({host.target.name}): chosen by llvm-mca on the "
            f"emitted loop for {target.row.mca_cpu}; the times are this host's, not the target's.",
            highlight=False,
        )
    notes = sorted({f"{c.compiler.code}: {c.march_note}" for c in candidates if c.march_note})
    for note in notes:
        console.print(note, highlight=False)
    console.print(f"chosen: {choice.chosen.name}", highlight=False, soft_wrap=True)
    console.print(f"ties with it: {len(choice.ties) - 1}", highlight=False)


def _rank(candidate: Candidate, foreign: bool) -> tuple[int, float, str]:
    if candidate.rejected:
        return 2, 0.0, candidate.name
    if foreign and candidate.mca is not None:
        return 0, candidate.mca.cycles_per_iteration, candidate.name
    if candidate.timing is not None:
        return 0, candidate.timing.ratio, candidate.name
    return 1, 0.0, candidate.name


def _label(candidate: Candidate) -> str:
    options = ".".join(code for _, code in candidate.variant.options)
    preset = preset_of(candidate)
    return f"{preset} ({options})" if preset else options


def _row(candidate: Candidate, choice: Choice, foreign: bool) -> list[str]:
    timing, verdict, mca = candidate.timing, candidate.verdict, candidate.mca
    row = [_label(candidate)]
    if foreign:
        row.append(f"{mca.cycles_per_iteration:.1f}" if mca else "-")
    if timing is not None:
        low, high = timing.ratio_ci
        latency = f"{timing.latency_ns:.0f}" if timing.latency_ns is not None else "-"
        row += [f"{timing.ns:.0f}", latency, f"{timing.ratio:.3f}", f"{low:.3f}-{high:.3f}"]
    else:
        row += ["-", "-", "-", "-"]
    row.append(f"{verdict.max_abs_error:.1e}" if verdict else "-")
    mark = (
        "chosen" if candidate is choice.chosen else "tie" if candidate.name in choice.ties else ""
    )
    row.append("rejected" if candidate.rejected else mark)
    return row
