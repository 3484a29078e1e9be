"""The parameters of a ball and a cushion, in the order of the struct that a call takes."""

from __future__ import annotations

from ..columns import Parameter

# Ranges are what the mechanics admits whatever the scene. What must hold of several at once, that
# the nose is above the centre and that compression ends, is a joint check (words.py).
PARAMETERS = (
    Parameter("R", "m", 1e-9, 1e3, "radius of the ball"),
    Parameter("M", "kg", 1e-9, 1e6, "mass of the ball"),
    Parameter("u_s", "1", 0.0, 1.0, "sliding friction of the ball and the table"),
    Parameter("u_w", "1", 0.0, 1.0, "friction of the ball and the cushion"),
    Parameter("e_c", "1", 0.0, 1.0, "restitution between the ball and the cushion"),
    Parameter("h", "m", 1e-9, 2e3, "height of the cushion's nose above the table, R to below 2 R"),
)
NAMES = tuple(parameter.name for parameter in PARAMETERS)
LIMITS = {parameter.name: (parameter.low, parameter.high) for parameter in PARAMETERS}
MEANINGS = {parameter.name: parameter.meaning for parameter in PARAMETERS}
UNITS = {parameter.name: parameter.unit for parameter in PARAMETERS}
