"""For which exact kernels fixed steps with a certificate are known (steppers/tiers)."""

from __future__ import annotations

from .scene import find_scene

_LEAST = {
    "mathavan2014": 1e-6,
    "bottom_slip": 1e-6,
    "pooltool": 1e-6,
}  # the tightest budget of a model's certificates

_STICKING = {
    "mathavan2014": (1e-6, 1e-3),
    "bottom_slip": (1e-6, 1e-3),
    "pooltool": (1e-6, 1e-3),
}  # the budgets of certificates for steps to where contact sticks: from, and below


def has_bound(model: str, budget: float) -> bool:
    """Is there a certificate for a model and a budget?"""
    return model in _LEAST and budget >= _LEAST[model]


def has_sticking(model: str, budget: float) -> bool:
    """Is there a certificate of steps to where contact sticks?"""
    least, below = _STICKING.get(model, (1.0, 0.0))
    return least <= budget < below


def takes_fixed_steps(scene: str) -> bool:
    """Are a scene's equations those that certificates are known of?"""
    known = find_scene(scene)
    return (
        known.equal_masses
        and known.table_friction
        and not known.level
        and known.precision == "double"
    )


def takes_tiers(scene: str) -> bool:
    """Do the checks of fixed steps in lanes cover what a scene refuses?"""
    known = find_scene(scene)
    restricted = (
        known.speed or known.spin_speed or known.object_ball != "any" or known.spin != "any"
    )
    return takes_fixed_steps(scene) and not restricted and not known.makes_varied
