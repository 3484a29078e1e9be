"""A lab without compilers or clocks: kernels have a speed by formula, with noise."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from generator.choice.kernel import Code, Emitted, Rejected, Verified
from generator.choice.trials import Rejection, Rules
from generator.choice.workbench import TimingJob
from generator.emission.kernel_source import KernelSource
from generator.evidence.records.code import source_hash
from generator.evidence.verification.verdict import Verdict
from generator.lowering.counts import OperationCounts
from generator.registry.axes import axis
from generator.registry.names import name_of, source_name_of
from generator.registry.question import Contest, Goal
from generator.registry.variant import Variant
from generator.sweep.explore import Progress
from generator.sweep.ledger import Ledger, new_run
from generator.sweep.store import ResultStore
from generator.sweep.sweep import Outcome, Plan, run_sweep
from generator.targets.target import find_target
from generator.toolchain.build import BuiltLibrary
from generator.toolchain.compilers import Compiler

ZEN3 = find_target("zen3")
HELD = ("ball-ball", "zen3", "any", "pooltool")
FIXED = Contest(*HELD, Goal(steps=1000), "scalar")
BATCH = Contest(*HELD, Goal(steps=1000), "batch")
EXACT = Contest(*HELD, Goal(budget=1e-6), "scalar")
EXACT_BATCH = Contest(*HELD, Goal(budget=1e-6), "batch")

Refuse = Callable[[Variant], Rejection | None]


def differing(variant: Variant) -> dict[str, str]:
    """Options that are not the default."""
    return {key: code for key, code in variant.options if code != axis(key).default}


@cache
def _effect(what: str, low: float, high: float) -> float:
    return random.Random(what).uniform(low, high)


def landscape(variant: Variant) -> float:
    """A ratio to the baseline: an effect for each option, and one for each pair of options."""
    odd = sorted({**differing(variant), "stepper": variant.stepper.name}.items())
    log = sum(_effect(f"{key}={code}", -0.25, 0.15) for key, code in odd)
    pairs = [(a, b) for n, a in enumerate(odd) for b in odd[:n]]
    log += sum(_effect(f"{pair}", -0.03, 0.03) for pair in pairs)
    return math.exp(log)


def made_up_source(variant: Variant) -> KernelSource:
    """A text that says what the compiler is shown of a variant, with its name in a comment."""
    shown = [(k, c) for k, c in differing(variant).items() if k not in ("compiler", "flags")]
    text = f"// {name_of(variant)}\n{sorted(shown)} {variant.stepper} {variant.width}"
    none = OperationCounts()
    return KernelSource(variant, source_name_of(variant), "", text, "", none, none)


class FakeLab:
    """`Lab` by formula. `timed` names what was timed, in order."""

    def __init__(
        self,
        seed: int = 0,
        noise: float = 0.01,
        refuse: Refuse = lambda variant: None,
        speed: Callable[[Variant], float] = landscape,
        seconds: float = 0.0,
    ) -> None:
        self.cpu = "zen3, made up"
        self.compilers = {"gcc": "g++ (made up) 12.2.0"}
        self.timed: list[tuple[str, ...]] = []
        self._random, self._noise = random.Random(seed), noise
        self._refuse, self._speed, self._seconds = refuse, speed, seconds

    def rules(self, contest: Contest) -> Rules:
        cases = f"{contest.goal.steps} {contest.batches}"
        return Rules(self.cpu, contest.call, cases, f"answers {cases}", "rules", "bench")

    def code(self, variant: Variant) -> Code:
        source = source_hash(made_up_source(variant))
        return Code(source, self.compilers["gcc"], (variant["flags"],))

    def emit(self, variant: Variant) -> Emitted:
        compiler = Compiler("gcc", "/usr/bin/g++", self.compilers["gcc"], 12)
        source, flags = made_up_source(variant), (variant["flags"],)
        return Emitted(variant=variant, source=source, compiler=compiler, flags=flags)

    def build(self, kernels: Sequence[Emitted]) -> Iterator[tuple[Emitted, Verified | Rejected]]:
        for kernel in kernels:
            rejection, place = self._refuse(kernel.variant), Path("/nowhere/kernel.so")
            verdict = Verdict(rejection is None, "made up", 1e-10, 1e-11, 10)
            built = kernel.built(BuiltLibrary(place, "key", 0.5, place, hit=False))
            made = built.verified(verdict)
            if rejection is None:
                yield kernel, made
            else:
                known = kernel if rejection.reason == "compile" else made
                yield kernel, Rejected(known, rejection.reason, rejection.text)

    def time(self, job: TimingJob) -> dict[str, Any]:
        time.sleep(self._seconds)
        self.timed.append(tuple(c.name for c in job.kernels))
        kernels = [self._series(c.name, self._ratio(c, job), job.rounds) for c in job.kernels]
        throughput = {"kernels": kernels, "control": self._series("control", 1.0, job.rounds)}
        return {
            "throughput": throughput,
            "latency": None,
            "seed_cases": None,
            "baseline": 0,
            "rounds": job.rounds,
            "tsc_ghz": 2.0,
            "cpu": 0,
        }

    def _ratio(self, candidate: Emitted, job: TimingJob) -> float:
        return 1.0 if candidate.name == job.baseline.name else self._speed(candidate.variant)

    def _series(self, name: str, ratio: float, rounds: int) -> dict[str, Any]:
        ns = [1e4 * ratio * math.exp(self._random.gauss(0, self._noise)) for _ in range(rounds)]
        return {"name": name, "ns_per_collision": ns, "tsc_cycles_per_collision": ns}


def plan(*contests: Contest, **changes: Any) -> Plan:
    return Plan(ZEN3, contests, **{"compilers": ("gcc",), **changes})


def swept(
    store: ResultStore,
    lab: FakeLab,
    asked: Plan,
    fresh: bool = False,
    observe: Callable[[Progress], None] = lambda progress: None,
) -> tuple[list[Outcome], Ledger]:
    """A whole sweep."""
    ledger = Ledger(store, new_run("a test", asked.seed, lab.cpu, "zen3", lab.compilers), fresh)
    return run_sweep(asked, lab, ledger, observe, time.monotonic()), ledger
