"""The parameters of two balls, in the order of the struct that a call takes."""

from __future__ import annotations

from ..columns import Parameter
from .terms import MASS_RATIOS

# Ranges are what the mechanics admits whatever the scene; R and M are divided by.
PARAMETERS = (
    Parameter("R", "m", 1e-9, 1e3, "radius of both balls"),
    Parameter("M", "kg", 1e-9, 1e6, "mass of both balls"),
    Parameter("u_s1", "1", 0.0, 1.0, "sliding friction of ball 1 and the table"),
    Parameter("u_s2", "1", 0.0, 1.0, "sliding friction of ball 2 and the table"),
    Parameter("u_b", "1", 0.0, 1.0, "friction between the balls"),
    Parameter("e_b", "1", 0.0, 1.0, "restitution between the balls"),
)
NAMES = tuple(parameter.name for parameter in PARAMETERS)
LIMITS = {parameter.name: (parameter.low, parameter.high) for parameter in PARAMETERS}
MEANINGS = {parameter.name: parameter.meaning for parameter in PARAMETERS}
UNITS = {parameter.name: parameter.unit for parameter in PARAMETERS}
TABLE_FRICTION = ("u_s1", "u_s2")
# The seventh, in scenes where both masses come with the call: M1 stands behind M, that of ball 2.
MASS_1 = "M1"
MASS_1_MEANING = "mass of ball 1: {:g} to {:g} times that of ball 2".format(*MASS_RATIOS)
# Cases have six parameters: of these scenes they have this mass for ball 1, their own M for ball 2.
CASE_M1 = 0.25  # kg


def case_value(key: str, row: str) -> str:
    """A parameter of a case as C++ text, its six from the array `row`."""
    return repr(CASE_M1) if key == MASS_1 else f"{row}[{NAMES.index(key)}]"
