"""A pytest plugin: pooltool's own tests meet our class where they name theirs."""

from __future__ import annotations

import pooltool.physics.resolve.ball_ball.frictional_mathavan as home

import carom.pooltool

home.FrictionalMathavan = carom.pooltool.FrictionalMathavan


def pytest_report_header() -> str:
    return "FrictionalMathavan is that of carom.pooltool"
