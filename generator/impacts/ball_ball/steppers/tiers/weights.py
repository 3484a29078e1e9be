"""Weights of the certificates, by contact model and budget: found by search, not derived.

docs/fixed-tiers.md says how.
"""

from __future__ import annotations

from dataclasses import replace

from .....tableaus.plain import BUTCHER_6, KUTTA_4
from .bounds import Bound, ByPhase, Sticks, StickWeights, Term, Tier

_WHOLE = Tier(
    steps=0,
    terms=(
        Term(0.0092, reach=2, turning=True),
        Term(0.645, reach=3, turning=True),
        Term(0.002, reach=2),
        Term(0.033, near=2),
        Term(0.102, near=3),
        Term(0.065, reach=1, near=1),
    ),
    most_way=0.85,
    most_near=0.75,
    work=0.004,
)
_ONE_A_PHASE = ByPhase(
    steps=1,
    first=(
        Term(0.0543, reach=2, turning=True),
        Term(5.53, reach=3),
        Term(0.19, near=2),
    ),
    second=(
        Term(0.037, reach=2, turning=True),
        Term(0.328, reach=4, turning=True),
        Term(0.307, reach=6, turning=True),
        Term(0.0123, reach=2),
        Term(0.0118, reach=6),
        Term(0.0042, near=2),
        Term(0.234, near=3),
    ),
)
_TWO_A_PHASE = ByPhase(
    steps=2,
    first=(
        Term(0.00933, reach=3, turning=True),
        Term(0.0343, reach=6, turning=True),
        Term(0.163, reach=6),
        Term(0.161, near=2),
    ),
    second=(
        Term(0.00205, reach=2, turning=True),
        Term(0.162, reach=6, turning=True),
        Term(0.0257, reach=6),
        Term(0.0251, near=2),
        Term(0.0132, near=5),
    ),
)
_FOUR_A_PHASE = Tier(
    steps=4,
    terms=(
        Term(0.00221, reach=2, turning=True),
        Term(0.0522, reach=4, turning=True),
        Term(0.0803, reach=3),
        Term(0.00924, near=1),
        Term(0.718, near=2),
    ),
    most_way=0.985,
    most_near=0.97,
)

_STICKS = Sticks(
    3.5e-7,
    one=StickWeights(2.78, 0.274, 0.0483, 0.0282, 0.0189),
    two=StickWeights(0.18, 0.0265, 0, 0.00145, 0.000316),
    bouncing=StickWeights(0.105, 0.0277, 0, 0, 0.00826, 0.0036, 0.0102),
)
_LIFT_STICKS = Sticks(
    3.5e-7,
    one=StickWeights(2.3, 0.231, 0.00116, 0.00647, 0.00588),
    two=StickWeights(0.0801, 0.00584, 2.63e-05, 0.000901, 8.44e-05),
    bouncing=StickWeights(0.0674, 0.00652, 0, 0.000683, 0.000366, 0.0158, 0),
)

BOTTOM_1E6 = Bound(
    2.5e-7,
    3.5e-7,
    BUTCHER_6,
    (_WHOLE, _ONE_A_PHASE, _TWO_A_PHASE, _FOUR_A_PHASE),
    sticks=_STICKS,
)
LIFT_1E6 = replace(BOTTOM_1E6, sticks=_LIFT_STICKS)

# Where the table drives its slip on, friction of the table counts for more.
_TOP_WHOLE = Tier(
    steps=0,
    terms=(
        Term(0.0111, reach=2, turning=True),
        Term(0.195, reach=3, turning=True),
        Term(0.604, reach=4, turning=True),
        Term(0.000339, reach=1),
        Term(0.000653, reach=2),
        Term(0.0209, near=2),
        Term(0.156, near=3),
        Term(0.0846, reach=2, near=1),
    ),
    most_way=0.85,
    most_near=0.75,
    work=0.00379,
)
_TOP_ONE_A_PHASE = ByPhase(
    steps=1,
    most_friction=0.03,
    first=(
        Term(0.0491, reach=2, turning=True),
        Term(0.00133, reach=2),
        Term(4240, reach=6),
        Term(0.0244, near=2),
        Term(0.11, near=3),
        Term(0.155, near=5),
    ),
    second=(
        Term(0.0327, reach=2, turning=True),
        Term(1580, reach=6, turning=True),
        Term(0.00253, reach=1),
        Term(0.0276, near=2),
        Term(0.102, near=3),
        Term(0.0231, near=5),
    ),
)
_TOP_TWO_A_PHASE = ByPhase(
    steps=2,
    most_friction=0.03,
    first=(
        Term(0.00107, reach=2, turning=True),
        Term(1.98, reach=6, turning=True),
        Term(7.49e-05, reach=1),
        Term(0.0357, reach=6),
        Term(0.000355, near=2),
        Term(0.00407, near=3),
        Term(0.0431, near=5),
    ),
    second=(
        Term(0.00118, reach=2, turning=True),
        Term(0.508, reach=6, turning=True),
        Term(0.000178, reach=1),
        Term(0.0101, reach=6),
        Term(0.00125, near=3),
        Term(0.039, near=5),
    ),
)

_TOP_STICKS = Sticks(
    3e-7,
    one=StickWeights(0.405, 0.48, 0.0378, 0.0135, 0.453),
    two=StickWeights(0.111, 0.0282, 0, 0, 0.0755),
    bouncing=StickWeights(0.0861, 0.0193, 0, 0, 0.0632, 0.0276, 0.0106),
    most_u_b=0.3,
    most_friction=0.06,
)

TOP_1E6 = Bound(
    1e-7,
    1e-7,
    BUTCHER_6,
    (_TOP_WHOLE, _TOP_ONE_A_PHASE, _TOP_TWO_A_PHASE),
    most_friction=0.03,
    most_u_b=0.25,
    most_u_s=0.6,
    sticks=_TOP_STICKS,
)

# Budgets of a thousandth: order 4.
_COARSE_WHOLE = Tier(
    steps=0,
    terms=(
        Term(0.0868, reach=1, turning=True),
        Term(0.894, reach=3, turning=True),
        Term(0.0558, reach=2),
        Term(0.0727, near=1),
        Term(0.109, near=3),
    ),
    most_way=0.89,
    most_near=0.79,
    work=0.689,
)
_COARSE_ONE_A_PHASE = ByPhase(
    steps=1,
    first=(
        Term(0.238, reach=1, turning=True),
        Term(69.2, reach=6),
        Term(0.183, near=1),
    ),
    second=(
        Term(0.489, reach=2, turning=True),
        Term(0.346, reach=3, turning=True),
        Term(0.942, reach=6),
        Term(0.815, near=1),
    ),
    most_friction=0.1,
    most_u_b=0.6,
    most_u_s=1.0,
)

BOTTOM_1E3 = Bound(3e-4, 3e-4, KUTTA_4, (_COARSE_WHOLE, _COARSE_ONE_A_PHASE), most_u_b=0.6)

_TOP_COARSE_WHOLE = Tier(
    steps=0,
    terms=(
        Term(0.0118, reach=1, turning=True),
        Term(0.415, reach=2, turning=True),
        Term(0.0116, near=1),
        Term(0.143, near=2),
    ),
    most_way=0.89,
    most_near=0.79,
    work=0.15,
)
_TOP_COARSE_ONE_A_PHASE = ByPhase(
    steps=1,
    first=(
        Term(1.48, reach=2, turning=True),
        Term(15.2, reach=6),
        Term(4.01, near=1),
    ),
    second=(
        Term(0.0505, reach=1, turning=True),
        Term(0.467, reach=2, turning=True),
        Term(0.993, reach=6),
    ),
    most_friction=0.1,
    most_u_b=0.6,
    most_u_s=1.0,
)

TOP_1E3 = Bound(
    3e-4,
    3e-4,
    KUTTA_4,
    (_TOP_COARSE_WHOLE, _TOP_COARSE_ONE_A_PHASE),
    most_friction=0.1,
    most_u_b=0.6,
)
