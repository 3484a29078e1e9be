"""For which exact kernels fixed steps with a certificate are known (steppers/tiers/bounds.py)."""

from __future__ import annotations

from ..impacts.ball_ball.scene import find_scene

_LEAST = {"mathavan2014": 1e-6}  # the tightest budget of a model's certificates


def has_bound(model: str, budget: float) -> bool:
    """Is there a certificate for a model and a budget?"""
    return model in _LEAST and budget >= _LEAST[model]


def takes_tiers(scene: str) -> bool:
    """Do the fixed steps' checks cover what a scene refuses, and its equations what it allows?"""
    known = find_scene(scene)
    restricted = (
        known.speed or known.spin_speed or known.object_ball != "any" or known.spin != "any"
    )
    plain = known.equal_masses and known.table_friction and not known.makes_varied
    return bool(plain and not restricted and known.precision == "double")
