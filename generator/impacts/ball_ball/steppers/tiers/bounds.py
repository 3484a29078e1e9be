"""What the certificates of fixed steps weigh, by model and budget.

The terms follow from where the rates are analytic (docs/fixed-tiers.md). Their weights are those
under which no collision of a search with an error over `error` is accepted,
times a margin; weights.py has them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from .....tableaus.plain import PlainTableau

MOST_ALONE = 2  # steps a phase


@dataclass(frozen=True)
class Term:
    """weight * factor * reach^(3 reach) * near^(3 near), over the impulse of friction.

    In tiers of several steps a phase both are those of the worst step, not of all the way.
    """

    weight: float
    reach: int = 0  # of the way to sticking
    near: int = 0  # to a passage of the table slip by zero
    turning: bool = False  # weighed by (k_x - k_z) |c_x| / |c|, else by u_s


@dataclass(frozen=True)
class Tier:
    """A way of `steps` in either phase, 0: one step over both; and where it is exact enough."""

    steps: int
    terms: tuple[Term, ...]
    most_way: float  # of the way to sticking that the collision goes
    most_near: float  # 1 where table slip passes zero
    work: float = 0.0  # weight of the error of J_c, times (1 - e^2) / e and near^4

    @property
    def by_step(self) -> bool:
        """Are reach and near those of its worst step?"""
        return self.steps > 1


@dataclass(frozen=True)
class ByPhase:
    """A way of `steps` in either phase that asks of each phase by itself.

    reach and near are those of a phase, whatever its steps.
    """

    steps: int
    first: tuple[Term, ...]
    second: tuple[Term, ...]
    most_way: float = 0.94  # of the way to sticking that is left to a phase
    most_near: float = 0.92
    most_friction: float = 0.06  # u_s u_b
    most_u_b: float = 0.25
    most_u_s: float = 0.6


@dataclass(frozen=True)
class StickWeights:
    """What steps into sticking miss, over u_s |c_z|."""

    passes: float  # near^6
    bends: float  # u_s near^3
    turns: float  # near^2 |c_x| / |c|
    rubs_s: float  # u_s u_b |c_x| / |c|, times u_s
    rubs_b: float  # and times u_b
    work_passes: float = 0.0  # (1 - e_b^2) near^3
    work_rubs: float = 0.0  # (1 - e_b^2) u_s u_b |c_x| / |c|


@dataclass(frozen=True)
class Sticks:
    """Steps over all of the way to c = 0, one or two, and the region that weights were found in."""

    error: float  # of |v1 - v2|
    one: StickWeights
    two: StickWeights
    bouncing: StickWeights  # two, where contact may stick in restitution
    cut: float = 0.45  # the root of the contact slip that is left between two steps
    most_u_b: float = 0.6
    most_u_s: float = 0.5
    most_friction: float = 0.12  # u_s u_b
    most_near: float = 0.85
    least_e_b: float = 0.4  # where contact sticks in restitution

    @property
    def chord(self) -> tuple[float, float]:
        """p, r: 1 / e_b <= p - r e_b from `least_e_b` to 1."""
        return 1 + 1 / self.least_e_b, 1 / self.least_e_b


@dataclass(frozen=True)
class Bound:
    """The tiers of a model and a budget, the cheapest first, and the region they are known in."""

    error: float  # of |v1 - v2|: what a collision may be off in any of them
    error_alone: float  # the same of single calls, whose numbers are doubles
    tableau: PlainTableau
    tiers: tuple[Tier | ByPhase, ...]
    least_e_b: float = 0.4
    most_friction: float = 0.12  # u_s u_b
    most_u_b: float = 1.0
    most_u_s: float = 1.0
    sticks: Sticks | None = None  # into sticking; None: no certificate is known

    @property
    def whole(self) -> Tier:
        """The first tier: one step over both phases."""
        first = self.tiers[0]
        if not isinstance(first, Tier):
            raise TypeError("the first tier is one step over all")
        return first

    @property
    def chord(self) -> tuple[float, float]:
        """p, r: 1 / e_b <= p - r e_b from `least_e_b` to 1."""
        return 1 + 1 / self.least_e_b, 1 / self.least_e_b

    def alone(self) -> Bound:
        """That of single calls. Four steps a phase take longer than the adaptive ones."""
        tiers = tuple(tier for tier in self.tiers if tier.steps <= MOST_ALONE)
        return replace(self, error=self.error_alone, tiers=tiers)
