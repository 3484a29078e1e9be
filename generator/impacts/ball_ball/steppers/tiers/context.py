"""What the templates of fixed steps with a certificate may see."""

from __future__ import annotations

from dataclasses import dataclass

from .....lowering.printer import number
from ...masses import EQUAL, pressed_changes
from ...terms import ContactTerms
from ..exact.pressed import Pressed
from .bounds import Bound
from .certificate import certificate, further
from .frame import changed, differences, entering, leaving, sizes
from .lookup import bound_for
from .sticking import StickText
from .whole import Text, advance, end, end_weights, finish, stage, stage_alone, turn

BLOCK, REST = 64, 128  # collisions that are read at once, and that may wait for the general way


@dataclass(frozen=True)
class TierContext:
    """The fixed steps of one kernel; names as in templates/tiers."""

    bound: Bound
    alone: bool  # for single calls, whose numbers are doubles
    differences: tuple[tuple[str, str], ...]  # what is made in doubles, by name
    sizes: tuple[tuple[str, str], ...]
    entering: Text
    certificate: Text  # of the first tier
    further: Text  # of the others
    stages: tuple[Text, ...]  # after the first
    powers: tuple[int, ...]  # the stages whose work counts
    end: Text
    advance: Text
    turn: Text
    finish: Text
    weights: tuple[tuple[str, str], ...]  # of the end, in w = 1 / (1 + e_b)
    leaving: Text
    changed: tuple[str, ...]
    columns: tuple[int, ...]  # of the inputs, for each output
    level_q: str  # the closed form where no ball is pressed, over (1 + e_b) V
    level_stick: str
    sticking: StickText | None  # steps to where contact sticks
    block: int = BLOCK
    rest: int = REST

    @property
    def source(self) -> str:
        return self.bound.tableau.source

    @property
    def evaluations(self) -> int:
        return self.bound.tableau.stages


def tier_context(
    terms: ContactTerms, budget: float, alone: bool, sticking: bool = False
) -> TierContext:
    """Decide everything that the templates of fixed steps show, for equal masses.

    `alone`: for single calls; `sticking`: with steps to where contact sticks.
    """
    bound = bound_for(terms, budget)
    bound, made = (bound.alone(), stage_alone) if alone else (bound, stage)
    pressed = Pressed.of(pressed_changes(terms, EQUAL))
    tableau, sticks = bound.tableau, bound.sticks if sticking else None
    return TierContext(
        bound=bound,
        alone=alone,
        differences=differences(terms),
        sizes=sizes(),
        entering=entering(terms),
        certificate=certificate(bound, pressed),
        further=further(bound, pressed),
        stages=tuple(made(tableau, pressed, i) for i in range(1, tableau.stages)),
        powers=tuple(i for i, weight in enumerate(tableau.b) if weight),
        end=end(tableau, pressed, alone),
        advance=advance(tableau, pressed),
        turn=turn(tableau, pressed),
        finish=finish(tableau, pressed, alone),
        weights=end_weights(tableau),
        leaving=leaving(terms),
        changed=changed(terms),
        columns=(*range(3, 9), *range(12, 18)),
        level_q="0.5",
        level_stick=number(1 / pressed.k_x),
        sticking=StickText.of(sticks, tableau, pressed, alone) if sticks else None,
    )
