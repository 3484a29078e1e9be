"""The printed parts of one exact kernel: its steps, and what is before and after them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .....lowering.statements import Part
from ...scene import Scene
from ..collision_ends import CollisionEnds, LevelForms
from .coefficients import printed
from .ellipse import sticking_bound
from .ends import Ending, EndLines, end_lines
from .lengths import PlanLines, plan_lines
from .passage import PassageLines, passage_lines
from .pressed import Pressed
from .stages import Kept
from .step import ExactLowering, ExactStep
from .sticking import Sticking, StickingLines, steepness_lines, sticking_lines

SLIPS_BEFORE = ("c_x", "c_z", "s1x", "s1y", "s2x", "s2y", "v_n")


@dataclass(frozen=True, kw_only=True)
class StepParts:
    """Of a step, of its interpolant and of its control."""

    step: ExactStep
    slip_names: tuple[str, ...]
    impulse_names: tuple[str, ...]
    gains: bool  # are changes of slips added up beside them (float, or a tight budget)?
    tail_bend: str  # the power of 1 - t on the way into sticking, where masses make it
    tail_steps: tuple[str, ...] = ()  # the stages of the step into sticking
    kept: tuple[Kept, ...] = ()  # what each stage leaves, where two vectors' are made in turn
    extra_stages: tuple[Part, ...] = ()  # for the interpolant alone
    dense_work: tuple[str, ...] = ()  # coefficients of the interpolants of t_y and of the work
    dense_contact: tuple[str, ...] = ()  # of the other impulses
    plan: PlanLines | None = None
    passage: PassageLines | None = None
    sticking: StickingLines | None = None
    ends: EndLines | None = None
    steepness: tuple[str, ...] = ()  # how near the table slip passes zero
    drift: tuple[str, ...] = ()  # b, the rate of the table slip
    landed: tuple[str, ...] = ()  # slips from the impulses of a part of a step


@dataclass(frozen=True)
class Writes:
    """What the parts of a step depend on beside its equations."""

    floats: bool
    divides: bool  # are roots taken, and divided by?
    dense: bool  # is the end of a collision taken anywhere in a step?
    paired: bool  # are the stages of two vectors made in turn?


def step_parts(lowering: ExactLowering, pressed: Pressed, how: Writes) -> StepParts:
    common = StepParts(
        step=lowering.parts(),
        slip_names=tuple(lowering.slips),
        impulse_names=tuple(lowering.impulses),
        gains=lowering.gains,
        tail_bend="" if lowering.tail_bend.is_number else printed(lowering.tail_bend),
        kept=lowering.kept() if how.paired and lowering.lanes else (),
    )
    if not lowering.table:
        return common
    drift = lowering.drift().lines
    gains = common.impulse_names if common.gains else ()
    last, scalar = lowering.tableau.stages - 1, not lowering.lanes
    ending = Ending(pressed, scalar, how.dense, last, common.slip_names, gains)
    sticking = Sticking(pressed, how.divides, sticking_bound(lowering.tableau)[1], gains)
    return replace(
        common,
        tail_steps=lowering.tail().lines,
        extra_stages=lowering.extra_stages(),
        dense_work=lowering.dense(("t_y", "j")).lines,
        dense_contact=lowering.dense(("d_x", "d_z", "t_x")).lines,
        plan=plan_lines(pressed, drift, how.floats),
        passage=passage_lines(pressed),
        sticking=sticking_lines(sticking),
        ends=end_lines(ending),
        steepness=steepness_lines(),
        drift=drift,
        landed=lowering.landed().lines,
    )


@dataclass(frozen=True, kw_only=True)
class EndParts:
    """Of both ends of a collision, and of its closed form where no ball is pressed."""

    before: tuple[str, ...]  # slips from velocities
    relative: tuple[str, ...]  # the components of v1 - v2
    after: tuple[str, ...]  # velocities from impulse sums
    level: LevelForms
    # The table slips, by the names they have, or 0.0 where known to be zero.
    slip_of: dict[str, str]


def end_parts(ends: CollisionEnds, scene: Scene, scaled: bool, lanes: bool) -> EndParts:
    """`scaled`: are speeds scaled before the steps?"""
    resting = ("s2x", "s2y") if scene.object_ball == "rest" else ()
    slips: tuple[str, ...] = SLIPS_BEFORE if scene.table_friction else ("c_x", "c_z", "v_n")
    if scene.level:
        slips = ("c_x", "v_n")
    after = ends.velocities() if scene.table_friction else ends.free_velocities()
    none = "real(0.0)" if lanes else "0.0"
    return EndParts(
        before=ends.slips(n for n in slips if n not in resting).lines,
        relative=ends.relative("per_scale" if scaled else "").lines,
        after=after.lines,
        level=ends.level(),
        slip_of={n: none if n in resting else n for n in ("s1x", "s1y", "s2x", "s2y")},
    )
