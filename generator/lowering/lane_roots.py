"""How kernels make 1 / sqrt in any number of lanes, as templates/lanes/roots.j2 lays it out."""

from __future__ import annotations

from dataclasses import dataclass

from ..registry.roots import refined_error
from ..targets.target import Target
from .isa import Estimate, estimate, float_estimate, root_itself


@dataclass(frozen=True, kw_only=True)
class LaneRoots:
    """Of one kernel; names as in templates/lanes."""

    real: str
    lane_estimate: tuple[str, ...]
    root_newton: int | None
    root_cubic: bool
    split_roots: bool  # may what a root is multiplied by go in before its last correction?
    estimates: bool  # is rsqrt_estimate an instruction's, where there is one?
    coarse: bool  # is the estimate so coarse that a root and a division do better than refining it?
    root_text: str
    tiny_square: str
    takes_roots: bool  # is the square root itself wanted?
    takes_powers: bool


@dataclass(frozen=True)
class Wanted:
    """What a stepper asks of the vocabulary beside 1 / sqrt."""

    lanes: bool  # is it for several lanes?
    powers: bool
    roots: bool


def lane_roots(method: str, target: Target, real: str, wanted: Wanted) -> LaneRoots:
    """1 / sqrt by a method of the axes `root` and `lane_root`."""
    found, newton, text = _roots(method, target, real, wanted.lanes)
    return LaneRoots(
        real=real,
        lane_estimate=found.scalar,
        root_newton=newton,
        root_cubic=method == "cubic",
        split_roots=wanted.powers and not wanted.lanes and bool(newton or method == "cubic"),
        estimates=method != "ieee",
        coarse=found.relative_error > 1e-3 or method == "ieee",
        root_text=text,
        tiny_square="1e-24" if real == "float" else "1e-36",
        takes_roots=wanted.roots or newton is None,
        takes_powers=wanted.powers,
    )


def _roots(method: str, target: Target, real: str, lanes: bool) -> tuple[Estimate, int | None, str]:
    def of(target: Target, newton: int) -> Estimate:
        if real == "float":
            return float_estimate(target, newton, lanes)
        return estimate(target, newton)

    if method in ("inv", "ieee"):
        return of(target, 0) if method == "inv" else root_itself(real), None, ""
    rounding = 2.0**-23 if real == "float" else 2.0**-52
    if method == "cubic":
        found = of(target, 0)
        error = max(refined_error(method, found.relative_error), rounding)
        return found, 0, f": {found.text}, then one step of third order, to {error:.0e}"
    steps = int(method[-1])
    found = of(target, steps)
    error = max(refined_error(method, found.relative_error), rounding)
    refined = f", then {steps} Newton" if steps else ""
    return found, steps, f": {found.text}{refined}, to {error:.0e}"
