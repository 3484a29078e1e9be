"""Collisions through the chosen kernel."""

from __future__ import annotations

from dataclasses import dataclass

from ..choice.lookup import require_runs, with_compiler_found
from ..evidence.verification.errors import Array
from .request import Request
from .session import Session

_START, _A_STEP, _USUAL_STEPS = 60.0, 1e-7, 10_000  # seconds, and as many steps as exact ones take


@dataclass(frozen=True)
class Collided:
    """What became of cases.

    `kernel`: its name. `outcomes`: a row for each case, its velocities (m/s and 1/s), then the
    status (0: collided; see `carom.h`). What did not collide keeps its velocities.
    """

    kernel: str
    outcomes: Array

    @property
    def collided(self) -> int:
        """How many cases have status 0."""
        return int((self.outcomes[:, -1] == 0).sum())


def collide(
    cases: Array, request: Request | None = None, session: Session | None = None
) -> Collided:
    """Run cases through the kernel that a request stands for.

    `cases`: a row for each, in the columns of the impact (SI units), as `read_cases` gives them.
    Raises InputError where the request cannot be, KernelError where the kernel cannot be built or
    run here.
    """
    session, wanted = session or Session(), (request or Request()).resolved()
    require_runs(wanted.host, wanted.target)
    steps = wanted.goal.steps
    variant = wanted.kernel(session)
    with session.workbench(impact=wanted.impact) as bench:
        variant = with_compiler_found(variant, bench.compilers)  # type: ignore[arg-type]
        candidate = bench.built(variant, wanted.target)
        outcomes = bench.tool.run_kernel(
            candidate.library.path,
            cases,
            steps=None if variant.stepper.steps == steps else steps,
            batch=wanted.request.batch,
            timeout=_START + _A_STEP * (steps or _USUAL_STEPS) * len(cases),
        )
    return Collided(candidate.name, outcomes)
