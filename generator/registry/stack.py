"""How much of the stack a kernel takes that is not optimised."""

from __future__ import annotations

from ..tableaus.tableaus import TABLEAUS
from .lane_numbers import precision_of
from .recipe import SERIES
from .variant import Variant

# carom.h promises at most 128 KiB of stack a function of unoptimised code, where every operation of
# a step has its own place. Vectors that Clang's `make_step` takes, by nonzero weights of stages and
# interpolant: 732 for 10 (ss43), 1116 for 26 (dp54), 1734 for 68 (dp87), 2795 for 130 (dop853).
# What is within that keeps to 32 KiB when optimised. In pairs (`s2`) every stage is a function.
MOST_UNOPTIMISED = 128 << 10
_STEP_VECTORS, _VECTORS_A_WEIGHT = 700, 17


def unoptimised_stack(v: Variant) -> int:
    """Bytes that the largest function of exact lanes takes of the stack, unoptimised; at most."""
    plain = v.stepper.family != "exact" or v.stepper.name == SERIES
    if v.width == 1 or plain or v.question.known_scene.closed_form or v.paired:
        return 0
    tableau = TABLEAUS[v.stepper.name]
    weights = sum(bool(weight) for row in (*tableau.rows, *tableau.dense) for weight in row)
    vector = v.width * v.vectors * (4 if precision_of(v) == "float" else 8)
    return vector * (_STEP_VECTORS + _VECTORS_A_WEIGHT * weights)
