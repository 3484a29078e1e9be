"""What the tests of the exact kernels need: kernels by budget, shots, errors by kind."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from generator.evidence.timing.bench_tool import BenchTool
from generator.evidence.verification.errors import Array, nudged
from generator.impacts.ball_ball.evidence import MODELS as MODELS
from generator.impacts.ball_ball.evidence.measure import SPEEDS, STATUS, errors_of, rounding_of
from generator.impacts.ball_ball.presets import find_preset
from generator.impacts.ball_ball.row import BALL_BALL
from generator.registry.roots import COARSEST_FIRST, allows
from generator.registry.rules import broken_rule
from generator.registry.variant import Stepper, Variant, make_variant
from generator.steppers.budgets import tableaus_for
from generator.targets.host import read_host
from generator.targets.target import Target, find_target
from generator.toolchain.build import BuiltLibrary
from tests.support import reference
from tests.support.kernels import EULER, build_all, compiler_of
from tests.support.reference import hexfloats as hexfloats
from tests.support.reference import keep as keep

BUDGETS = (1e-3, 1e-4, 1e-6, 1e-9, 1e-12)
COMPILERS = ("gcc", "clang")
R, M = 0.028575, 0.170097  # of the tests' own shots


def host_target() -> Target:
    """The target of this machine: what a user gets from `--target native`."""
    return read_host().target


def portable_target() -> Target:
    """One that runs on any machine of the last ten years, and tests what most users run."""
    host = read_host()
    portable = find_target("x86-64-v3")
    return portable if host.runs(portable) else host.target


def roots_for(budget: float, model: str, target: Target) -> tuple[str, ...]:
    """Choices of 1/sqrt that the rules allow for a budget, the coarsest first."""
    return tuple(
        code
        for code in COARSEST_FIRST
        if allows(budget, BALL_BALL.sensitivity(model), code, target)
    )


def exact_variant(
    model: str,
    budget: float,
    compiler: str = "gcc",
    root: str = "",
    target: Target | None = None,
    tableau: str = "",
) -> Variant:
    """The kernel for a budget; where not named, its tableau and the cheapest legal root."""
    target = target or portable_target()
    stepper = Stepper(tableau or tableaus_for(budget)[0], budget=budget)
    fma = "fma" if target.has("fma") else "nofma"
    for choice in (root,) if root else roots_for(budget, model, target):
        options = {"root": choice, "fma": fma, "compiler": compiler}
        made = make_variant(target.name, "any", model, stepper, 1, **options)
        if broken_rule(made, target) is None:
            return made
    raise AssertionError(f"no legal exact kernel for {target.name} with root {root or 'any'}")


def fixed_step_variant(model: str, compiler: str = "gcc") -> Variant:
    """Our usual fixed-step kernel, exact in its arithmetic."""
    target = portable_target()
    fma = "fma" if target.has("fma") else "nofma"
    options = {**find_preset("reduced").options, "fma": fma, "compiler": compiler}
    return make_variant(target.name, "any", model, EULER, 1, **options)


def built(variants: Sequence[Variant]) -> list[Path]:
    """Libraries of variants; a failure to compile fails the test."""
    results = build_all(list(variants))
    broken = [str(result) for result in results if not isinstance(result, BuiltLibrary)]
    assert not broken, "\n".join(broken)
    for each in variants:
        assert compiler_of(each).code == each["compiler"], f"{each['compiler']} is not installed"
    return [result.path for result in results if isinstance(result, BuiltLibrary)]


# -- errors ----------------------------------------------------------------------------------------


def load_hard() -> tuple[tuple[str, ...], Array]:
    """Kinds and rows of 24 of the cases that a kernel once failed; any model may meet them."""
    kinds, rows = reference.load_hard()
    return tuple(f"hard {kind}" for kind in kinds), rows


def conditioning(tool: BenchTool, model: str, case: Array) -> float:
    """How far the exact result moves when speeds change by a rounding, relative.

    No kernel in double that projects speeds on the line of centres can be surely nearer.
    """
    cases = nudged(case, 32, SPEEDS)
    exact = tool.expect(cases, "exact", model)
    return float(errors_of(cases, exact, np.tile(exact[0], (32, 1))).relative.max())


FEW = 20  # cases of a chunk that may be asked after: a kernel that misses more is wrong


@dataclass
class Worst:
    """The largest relative errors of a kernel, over all and by kind, as cases come by."""

    budget: float
    moved: Callable[[Array], float] | None = None  # how far a rounding moves a case's exact result
    count: int = 0
    steep: int = 0  # cases beyond the budget, but no further than that
    over: int = 0  # cases beyond the budget
    wrong_status: int = 0
    error: float = 0.0
    kind: str = ""
    case: Array | None = None

    def __post_init__(self) -> None:
        self.by_kind: dict[str, tuple[float, int, Array]] = {}  # error, cases over, worst case

    def add(self, cases: Array, kinds: Sequence[str], got: Array, expected: Array) -> None:
        relative = errors_of(cases, got, expected).relative
        status = got[:, STATUS] != expected[:, STATUS]
        relative = np.where(status, np.inf, relative)
        allowed = np.maximum(self.budget, rounding_of(cases))
        self.count += len(cases)
        self.wrong_status += int(status.sum())
        self._allow_steep(cases, relative, allowed)
        self.over += int((relative > allowed).sum())
        names = np.array(kinds)
        for kind in dict.fromkeys(kinds):
            rows = np.flatnonzero(names == kind)
            row = rows[np.argmax(relative[rows])]
            most, over, case = self.by_kind.get(kind, (-1.0, 0, cases[row]))
            over += int((relative[rows] > allowed[rows]).sum())
            if relative[row] > most:
                most, case = float(relative[row]), cases[row].copy()
            self.by_kind[kind] = (most, over, case)
        self.kind, (self.error, _, self.case) = max(self.by_kind.items(), key=lambda k: k[1][0])

    def _allow_steep(self, cases: Array, relative: Array, allowed: Array) -> None:
        """Raises what is allowed where the exact result itself is as uncertain as its input."""
        beyond = np.flatnonzero((relative > allowed) & np.isfinite(relative))
        if self.moved is None or len(beyond) > FEW:
            return
        for i in beyond:
            allowed[i] = max(allowed[i], self.moved(cases[i]))
        self.steep += int((relative[beyond] <= allowed[beyond]).sum())

    @property
    def passed(self) -> bool:
        return self.count > 0 and self.over == 0 and self.wrong_status == 0

    def failing(self) -> list[tuple[str, Array]]:
        """The worst case of each kind that is over the budget."""
        return [(kind, case) for kind, (_, over, case) in self.by_kind.items() if over]

    def line(self) -> str:
        """What a failure says: figure, kind and the case itself."""
        assert self.case is not None
        return (
            f"{self.error:.3g} > {self.budget:g} ({self.kind}; {self.over} of {self.count} cases "
            f"over, {self.wrong_status} with another status)\n    {hexfloats(self.case)}"
        )


# -- shots -----------------------------------------------------------------------------------------


def shot(
    v1: Sequence[float] = (0.0, 1.0, 0.0),
    w1: Sequence[float] = (0.0, 0.0, 0.0),
    v2: Sequence[float] = (0.0, 0.0, 0.0),
    w2: Sequence[float] = (0.0, 0.0, 0.0),
    params: Sequence[float] = (R, M, 0.2, 0.2, 0.05, 0.95),
    direction: Sequence[float] = (0.0, 1.0),
) -> Array:
    """A case of 24 numbers: balls that touch, ball 1 at the origin, ball 2 in `direction`."""
    radius = params[0]
    x, y = np.array(direction) / np.hypot(*direction)
    one, two = (0.0, 0.0, radius), (2 * radius * x, 2 * radius * y, radius)
    return np.array([*params, *one, *v1, *w1, *two, *v2, *w2], dtype=np.float64)
