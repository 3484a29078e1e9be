"""The main job: derive, emit, compile, verify, time or model, choose, write."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from ..choice.candidates import candidates_of, published_name
from ..choice.choose import Choice
from ..choice.entries import selected, write_selected
from ..choice.folder import checked_selection, require_writable
from ..choice.job import STEPS, Held, hold, hold_batches
from ..choice.kernel import Estimated, Rejected, Timed, Verified, verdict_of
from ..choice.selection import Selected, place_of
from ..choice.workbench import Workbench
from ..errors import InputError
from ..evidence.verification.evidence import evidence_of
from ..registry.question import DEFAULT_IMPACT, Contest, Goal, find_impact
from ..targets.host import Host
from ..targets.target import Target
from ..toolchain.replay import Modelled
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
            return [model.name for model in find_impact(self.impact).model_table()]
        impact = find_impact(self.impact)
        return [impact.find_model(self.model or impact.find_scene(self.scene).model).name]

    def goals(self, model: str) -> list[Goal]:
        """What is asked of a model: fixed steps, an error budget, or both."""
        impact = find_impact(self.impact)
        scene = impact.find_scene(self.scene)
        budget = self.max_error or scene.max_error
        candidates_of(impact).tableaus_for(budget)  # is it in range?
        exact = [Goal(budget=budget)] if model not in evidence_of(impact).exact_models else []
        steps = [Goal(steps=STEPS)] if self.max_error is None and scene.fixed_steps else []
        if not (found := [*steps, *exact]):
            raise InputError(f"--max-error: model {model} has fixed steps alone; leave it out")
        return found


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
class Decision:
    """The kernels of a contest, and the one that was chosen.

    `labels`: of the cases that were verified on. `entry`: the choice as selection.json has it.
    """

    contest: Contest
    candidates: tuple[Verified | Rejected, ...]
    choice: Choice
    entry: Selected
    labels: tuple[str, ...]

    @property
    def baseline(self) -> Verified | Rejected:
        """What all are compared with."""
        return self.candidates[0]

    @property
    def over(self) -> str:
        """What errors are relative to, as |...|."""
        return self.contest.row.relative_symbol

    @property
    def baseline_name(self) -> str:
        """What that is called."""
        return candidates_of(self.contest.row).baseline

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
        return f"{self.contest.model}, {words}, {calls}"

    @property
    def recipe(self) -> str:
        """The recipe of the choice."""
        return str(self.choice.chosen.variant.recipe)

    @property
    def rejected(self) -> dict[str, str]:
        """Why candidates were, by name."""
        return {c.name: c.text for c in self.candidates if isinstance(c, Rejected)}

    @property
    def model(self) -> Modelled | None:
        """What llvm-mca gave of the choice, where it was asked."""
        return _model(self.choice.chosen)

    @property
    def compiler_notes(self) -> list[str]:
        """Of compilers that do not know the target's CPU."""
        made = (candidate.emitted for candidate in self.candidates)
        return sorted({f"{e.compiler.code}: {e.march_note}" for e in made if e.march_note})

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

    def _row(self, c: Verified | Rejected) -> Row:
        timing = c.timing if isinstance(c, Timed) else None
        found = c.record.record if isinstance(c, Estimated) and c.record else None
        timed, cycles, first = timing or found, _cycles(c), _cycles(self.baseline)
        ratio, interval = (timed.ratio, timed.ratio_ci) if timed else (None, None)
        if self.choice.by == "llvm-mca":  # one meaning a column: times beside models do not compare
            ratio, interval = (cycles / first if cycles and first else None), None
        verdict = verdict_of(c)
        return Row(
            label=published_name(c.variant) or f"{c.variant.question.width} {c.variant.recipe}",
            ns=timed.ns if timed else None,
            latency=timing.latency_ns if timing else None,
            cycles=cycles,
            ratio=ratio,
            interval=interval,
            error=verdict.max_rel_error if verdict else None,
            mark=self._mark(c),
        )

    def _mark(self, candidate: Verified | Rejected) -> Literal["chosen", "tie", "rejected", ""]:
        if isinstance(candidate, Rejected):
            return "rejected"
        if candidate.name == self.choice.chosen.name:
            return "chosen"
        return "tie" if candidate.name in self.choice.ties else ""


def _model(kernel: Verified | Rejected) -> Modelled | None:
    return kernel.model if isinstance(kernel, Estimated) else None


def _cycles(kernel: Verified | Rejected) -> float | None:
    model = _model(kernel)
    return model.cycles if model else None


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
    decisions: tuple[Decision, ...]
    emulator: str
    reused: str


def generate(request: GenerateRequest | None = None, session: Session | None = None) -> Generated:
    """Choose the kernels for a CPU and write its folder of `generated/`, contest after contest.

    Raises InputError where the request cannot be or the folder cannot be written, KernelError where
    no candidate passed; what was chosen before is then written.
    """
    session, asked = session or Session(), request or GenerateRequest()
    impact = find_impact(asked.impact)
    target, host = resolve_target(asked.target)
    goals = {model: asked.goals(model) for model in asked.models()}
    folder = place_of(asked.out or session.generated, asked.target, asked.scene, asked.impact)
    checked_selection(folder)  # what is wrong with it shall be said before the work, not after
    require_writable(folder)
    made: list[Decision] = []
    with session.workbench(target, asked.fresh, impact=impact) as bench:
        for model in goals:
            for goal in goals[model]:
                held = (asked.impact, target.name, asked.scene, model)
                made += _decided(bench, Contest(*held, goal, "scalar"), host, asked.seconds)
                write_selected(folder, asked.target, [decision.entry for decision in made])
        emulator = Path(bench.emulated.emulator[0]).name if bench.emulated else ""
        reused = bench.store.counts()
    return Generated(target, host, asked.scene, folder, tuple(made), emulator, reused)


def _decided(bench: Workbench, contest: Contest, host: Host, seconds: float) -> list[Decision]:
    """The contest of single calls, and that of batches for the same goal."""
    singles = hold(bench, contest, host, seconds)
    batches = hold_batches(bench, singles, host, seconds)
    return [_told(bench, held) for held in (singles, batches) if held is not None]


def _told(bench: Workbench, held: Held) -> Decision:
    choice, labels = held.choice, bench.cases.of(held.choice.chosen.variant).labels
    return Decision(held.contest, tuple(held.kernels), choice, selected(choice), labels)
