"""Whether kernels are right: on the cases of their scene, and under the worst root estimates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any

from ..errors import KernelError
from ..evidence.records.code import key_of
from ..evidence.timing.bench_tool import BenchTool, Way
from ..evidence.timing.emulated import EmulatedRunner
from ..evidence.verification.errors import Array
from ..evidence.verification.verdict import Verdict, with_worst
from ..evidence.verification.worst_estimates import PATTERNS, at_worst
from ..lowering.isa import estimates_in
from ..registry.variant import Variant
from ..toolchain.build import build, cache_key
from .cases import Cases
from .kernel import Built, Emitted, Rejected, Verified
from .verifying import Run, broken, verdict_from, verdicts, worst_verdict

PATIENCE = 30.0  # seconds for a kernel over all cases; the slowest of 1000 steps take half a second
A_STEP = 0.01  # seconds more for each fixed step
EMULATED = 10  # times as long under an emulator


@dataclass
class Verifier:
    """Gives verdicts, from the store or new."""

    tool: BenchTool
    cache: Path
    cases: Cases
    emulated: EmulatedRunner | None = None  # runs kernels of another architecture
    patience: float = PATIENCE

    def verify(self, kernel: Built) -> Verified | Rejected:
        """On the reference, random and hard cases of its scene, under this CPU's estimates."""
        variant, expected = kernel.variant, self.cases.of(kernel.variant)
        kept = self.cases.store.kept(
            "verdicts",
            self._key(kernel.library.key, kernel),
            lambda: verdicts(self._runner(variant, kernel.library.path), variant, expected),
        )
        verdict, pooltool = verdict_from(kept["oracle"]), None
        if kept["pooltool"] is not None:
            pooltool = verdict_from(kept["pooltool"])
        found = kernel.verified(verdict, pooltool)
        if not verdict.passed:
            return _failed(found, verdict, "verification")
        if pooltool is not None and not pooltool.passed:
            return _failed(found, pooltool, "verification against pooltool's own answers")
        return found

    def verify_at_worst(self, kernel: Verified) -> Verified | Rejected:
        """Under the worst root estimates that are allowed, where it has any."""
        if not estimates_in(kernel.source.source):
            return kernel
        variant, job = kernel.variant, at_worst(kernel.build_job)
        expected = self.cases.of(variant)
        patterns = [asdict(pattern) for pattern in PATTERNS]

        def make() -> dict[str, Any]:
            try:
                library = build(job, self.cache / "kernels").path
            except KernelError as error:
                return broken(error, expected)
            return worst_verdict(partial(self._runner, variant, library), variant, expected)

        key = self._key(cache_key(job), kernel, patterns)
        worst = verdict_from(self.cases.store.kept("verdicts under worst estimates", key, make))
        found = replace(kernel, verdict=with_worst(kernel.verdict, worst))
        return found if worst.passed else _failed(found, worst, "verification")

    def _key(self, library: str, kernel: Emitted, *more: object) -> str:
        expected, goal = self.cases.of(kernel.variant).key, str(kernel.variant.stepper.goal)
        rules = verification_hash(self.tool.impact.folder)
        return key_of(library, expected, rules, goal, self.patience, *more)

    def _runner(
        self, variant: Variant, library: Path, environment: Mapping[str, str] | None = None
    ) -> Run:
        """Runs cases through a library, one by one or as a batch."""
        limit = self.patience + A_STEP * (variant.stepper.steps or 0)

        def run(cases: Array, batch: bool) -> Array:
            if self.emulated is not None:
                limit_there = EMULATED * limit
                return self.emulated.run_kernel(library, cases, batch=batch, timeout=limit_there)
            return self.tool.run_kernel(
                library, cases, batch=batch, timeout=limit, way=Way(environment=environment)
            )

        return run


def _failed(kernel: Verified, verdict: Verdict, against: str) -> Rejected:
    return Rejected(kernel, verdict.ended or "wrong result", f"{against}: {verdict.reason}")


@cache
def verification_hash(impact: str) -> str:
    """Hash of the rules of verification: a verdict holds only under the rules it was given by.

    `impact`: the folder of the one whose rules are asked for.
    """
    package = Path(__file__).parents[1]
    own = package / "impacts" / impact
    folders = package / "evidence" / "verification", own / "evidence"
    files = [path for folder in folders for path in sorted(folder.rglob("*.py"))]
    files += sorted(own.glob("evidence.py"))  # an impact gives a package, or one module
    return key_of(*(path.read_text("utf-8") for path in files))
