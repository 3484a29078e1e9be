"""The main job: derive, emit, compile, verify, time or model, choose, write."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from ..choice.batches import batch_job
from ..choice.choose import Choice, selected
from ..choice.folder import checked_selection, require_writable, write_folder
from ..choice.job import Job, exact_job, fixed_step_job
from ..choice.selection import Selected, Selection, place_of
from ..choice.workbench import Candidate, Workbench
from ..impacts.ball_ball.models import MODELS, find_model
from ..impacts.ball_ball.scene import find_scene
from ..registry.presets import preset_of
from ..registry.question import DEFAULT_IMPACT, find_impact
from ..steppers.exact.budgets import plan_for
from ..targets.host import Host
from ..targets.target import Target
from .session import Session, resolve_target


@dataclass(frozen=True)
class GenerateRequest:
    """What to generate.

    `target`: a CPU, or `native`. `scene`: what is known of a shot. `model`: a contact model, or
    `all`; None: the scene's. `max_error`: this error budget alone; None: fixed steps and the
    scene's budget. `seconds`: of timing for each contest. `fresh`: verify and time anew what an
    earlier run did. `out`: a folder instead of `generated/`. `impact`: what collides.
    """

    target: str = "native"
    scene: str = "any"
    model: str | None = None
    max_error: float | None = None
    seconds: float = 30.0
    fresh: bool = False
    out: Path | None = None
    impact: str = DEFAULT_IMPACT

    def models(self) -> list[str]:
        """The names of the models. Raises InputError where there is none such."""
        if self.model == "all":
            return [m.name for m in MODELS]
        return [find_model(self.model or find_scene(self.scene).model).name]


@dataclass(frozen=True)
class Row:
    """A candidate's figures; None: not known.

    `label`: the report's name, or the recipe. `ns`, `latency`: of a collision. `cycles`: of one, by
    llvm-mca. `ratio`: to paper-initial, `interval` at 95 %. `error`: largest, over |v1 - v2|,
    against the contest's reference. `mark`: chosen, tie, rejected, or empty.
    """

    label: str
    ns: float | None
    latency: float | None
    cycles: float | None
    ratio: float | None
    interval: tuple[float, float] | None
    error: float | None
    mark: Literal["chosen", "tie", "rejected", ""]


@dataclass(frozen=True)
class Contest:
    """Kernels that answer one question, and the one that was chosen.

    `labels`: of the cases that were verified on. `entry`: the choice as selection.json has it.
    """

    model: str
    candidates: tuple[Candidate, ...]
    baseline: Candidate
    choice: Choice
    entry: Selected
    labels: tuple[str, ...]

    @property
    def fixed(self) -> bool:
        """Fixed steps, with errors against the same scheme; else against the exact solution."""
        return self.entry.goal.steps is not None

    @property
    def title(self) -> str:
        """The question in words."""
        goal = self.entry.goal
        words = f"N = {goal.steps}" if self.fixed else f"within {goal.budget:g}"
        calls = "batches" if self.choice.chosen.is_batch else "single calls"
        return f"{self.model}, {words}, {calls}"

    @property
    def recipe(self) -> str:
        """The recipe of the choice."""
        return str(self.choice.chosen.variant.recipe)

    def rows(self) -> list[Row]:
        """Every candidate whose error is against the contest's reference, the fastest first."""
        own = [c for c in self.candidates if (c.variant.stepper.steps is not None) is self.fixed]
        rows = [self._row(c) for c in own]
        return sorted(rows, key=lambda r: (r.mark == "rejected", r.ratio is None, r.ratio or 0.0))

    def front(self) -> list[Row]:
        """The rows that no other beats in speed and error, the fastest first."""
        front: list[Row] = []
        for row in self.rows():
            least = min((r.error for r in front if r.error is not None), default=float("inf"))
            if row.mark == "rejected" or row.ratio is None or row.error is None:
                continue
            if row.error < least:
                front.append(row)
        return front

    def _row(self, candidate: Candidate) -> Row:
        c, kept = candidate, candidate.recorded.record if candidate.recorded else None
        first = self.baseline.modelled
        timed = c.timing or kept
        ratio, interval = (timed.ratio, timed.ratio_ci) if timed else (None, None)
        if self.choice.by == "llvm-mca":  # one meaning a column: times beside models do not compare
            ratio = c.modelled.cycles / first.cycles if c.modelled and first else None
            interval = None
        return Row(
            label=preset_of(c.variant) or f"{c.variant.question.width} {c.variant.recipe}",
            ns=timed.ns if timed else None,
            latency=c.timing.latency_ns if c.timing else None,
            cycles=c.modelled.cycles if c.modelled else None,
            ratio=ratio,
            interval=interval,
            error=c.verdict.max_rel_error if c.verdict else None,
            mark=self._mark(c),
        )

    def _mark(self, candidate: Candidate) -> Literal["chosen", "tie", "rejected", ""]:
        if candidate.rejected:
            return "rejected"
        if candidate is self.choice.chosen:
            return "chosen"
        return "tie" if candidate.name in self.choice.ties else ""


@dataclass(frozen=True)
class Generated:
    """What was chosen, contest after contest, and the folder that holds it.

    `emulator`: the program that ran kernels of another architecture; empty: this machine did.
    `reused`: what was taken from earlier runs, in words; empty: nothing.
    """

    target: Target
    host: Host
    scene: str
    folder: Path
    contests: tuple[Contest, ...]
    emulator: str
    reused: str


def generate(request: GenerateRequest | None = None, session: Session | None = None) -> Generated:
    """Choose the kernels for a CPU and write its folder of `generated/`, contest after contest.

    Raises InputError where the request cannot be or the folder cannot be written, KernelError where
    no candidate passed; what was chosen before is then written.
    """
    session, asked = session or Session(), request or GenerateRequest()
    find_impact(asked.impact)
    target, host = resolve_target(asked.target)
    known, models = find_scene(asked.scene), asked.models()
    budget = asked.max_error or known.max_error
    plan_for(budget)
    folder = place_of(asked.out or session.generated, asked.target, asked.scene, asked.impact)
    checked_selection(folder)  # what is wrong with it shall be said before the work, not after
    require_writable(folder)
    fixed = [fixed_step_job] if asked.max_error is None and known.fixed_steps else []
    contests: list[Contest] = []
    with session.workbench(target, asked.fresh) as bench:
        for model in models:
            for job in [*fixed, exact_job(budget)]:
                contests += _held(bench, job, target, host, model, asked)
                _write(folder, asked, target, contests)
        emulator = Path(bench.emulated.emulator[0]).name if bench.emulated else ""
        reused = bench.reused()
    return Generated(target, host, asked.scene, folder, tuple(contests), emulator, reused)


def _held(
    bench: Workbench, job: Job, target: Target, host: Host, model: str, asked: GenerateRequest
) -> list[Contest]:
    """The contests of single calls and of batches for one goal."""
    candidates, first, choice = job(bench, target, host, asked.scene, model, asked.seconds)
    found = [(candidates, first, choice)]
    batches = batch_job(bench, target, host, asked.scene, first, choice.chosen, asked.seconds)
    return [
        Contest(model, tuple(each), base, chosen, selected(chosen, base), bench.labels)
        for each, base, chosen in [*found, *([batches] if batches else [])]
    ]


def _write(folder: Path, asked: GenerateRequest, target: Target, contests: list[Contest]) -> None:
    selection = checked_selection(folder) or Selection(
        impact=asked.impact,
        target=asked.target,
        resolved=target.name,
        scene=asked.scene,
        kernels=[],
    )
    selection = selection.model_copy(update={"resolved": target.name})
    write_folder(folder, selection.with_entries([contest.entry for contest in contests]))
